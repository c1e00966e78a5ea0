#include "app/report/site/report_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/chain/build_info.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/compare_page.hpp"
#include "app/report/page/run_page.hpp"
#include "app/report/site/index_row.hpp"
#include "app/report/site/site_record.hpp"
#include "app/study/answers/verify_study.hpp"
#include "ident/base/printable.hpp"
#include "io/archive/archive.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Program and settings as text. If this text or the archive changes, the pages are made again.
std::string site_maker(const ReportConfig& options) {
  return fmt::format("modebank {} {}, report.size_mb {}, report.runs {}", build_info::version, build_info::git_revision,
                     options.size_mb, options.runs);
}

/// The pages of a folder while `report` works.
class Site {
 public:
  Site(fs::path folder, fs::path site, const ReportConfig& options, Written& written)
      : folder_(std::move(folder)),
        site_(std::move(site)),
        options_(options),
        written_(written),
        before_(read_site_record(site_)) {}

  bool is_new() const { return !fs::exists(site_ / "index.html"); }

  SiteResult write() {
    make_own_folder(site_);
    const std::vector<fs::path> names = archives_below(folder_);
    now_ = before_;
    json rows = json::array();
    for (const fs::path& name : names) rows.push_back(row_of(name));
    for (auto made = now_.begin(); made != now_.end();)
      made = whole_.count(made->first) ? std::next(made) : now_.erase(made);
    write_index(rows);
    remove_others();
    write_site_record(site_, now_);
    result_.archives = names.size();
    return result_;
  }

 private:
  /// The row of the index for an archive. If needed, first makes the archive's pages.
  json row_of(const fs::path& name) {
    json row = {{"name", name.string()}};
    try {
      const fs::path path = folder_ / name;
      fs::is_directory(path) ? add_study(name, find_study(path, silent_), row) : add_archive(name, path, row);
      row["archive"] = fs::absolute(path).lexically_normal().string();
      whole_.insert(name.string());
    } catch (const std::exception& error) {
      std::string why = printable(error.what());
      if (const std::string path = (folder_ / name).string() + ": "; why.rfind(path, 0) == 0) why.erase(0, path.size());
      row["problem"] = why;
      result_.problems.emplace_back(name.string(), why);
    }
    return row;
  }

  void add_archive(const fs::path& name, const OpenArchive& archive, json& row) {
    if (is_study(archive)) return add_study(name, find_study(archive), row);
    row.update(index_row(archive));
    row["page"] = page_of(name, name, archive.digest(), [&](const fs::path& page, Written& pages) {
      check_page_path(page, {archive.path()});
      const Archive content = read_archive(archive, Evaluations::in_file);
      write_page(page, run_page(content, archive.path().filename().string(), options_), pages);
    });
  }

  /// A study's folder may have the same name as an archive beside it.
  void add_study(const fs::path& name, const FoundStudy& study, json& row) {
    row.update(index_row(study));
    const fs::path file = fs::is_directory(folder_ / name) ? name / "study.h5" : name;
    row["page"] = page_of(name, file, study.digest,
                          [&](const fs::path& page, Written& pages) { report_study(study, page, options_, pages); });
  }

  /// Returns false for the page of an unfinished study.
  bool is_current(const std::string& name, const std::string& digest) const {
    const auto found = before_.find(name);
    if (digest.empty() || found == before_.end()) return false;
    if (found->second.archive != digest || found->second.maker != maker_) return false;
    const std::vector<std::string>& files = found->second.files;
    return std::all_of(files.begin(), files.end(), [&](const std::string& file) { return fs::exists(site_ / file); });
  }

  /// Address of an archive's page in the site. `write` makes this page and the pages that belong to it.
  template <class Write>
  std::string page_of(const fs::path& name, const fs::path& file, const std::string& digest, Write write) {
    const fs::path page = ("pages" / file).replace_extension(".html");
    if (is_current(name.string(), digest)) return page.string();
    // This is recorded before the page exists, so that the pages of a killed run can be removed later.
    SitePages& made = now_[name.string()];
    made.archive.clear();
    if (made.files.empty()) made.files = {page.string()};
    write_site_record(site_, now_);
    fs::create_directories((site_ / page).parent_path());
    const std::size_t first = written_.files.size();
    Written pages = silent_;
    write(site_ / page, pages);
    written_.files.insert(written_.files.end(), pages.files.begin(), pages.files.end());
    made = {digest, maker_, {page.string()}};
    for (std::size_t i = first; i < written_.files.size(); ++i)
      if (const fs::path other = fs::path(written_.files[i]).lexically_relative(site_); other != page)
        made.files.push_back(other.string());
    return page.string();
  }

  void write_index(const json& rows) {
    const fs::path path = fs::absolute(folder_).lexically_normal();
    const std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
    Page page;
    page.title = fmt::format("{} · modebank", name);
    page.script = assets::index_js();
    page.data = {{"kind", "index"}, {"folder", name}, {"most_compared", most_compared}, {"rows", rows}};
    write_page(site_ / "index.html", page, written_);
  }

  /// Removes pages of earlier runs that are no longer needed.
  void remove_others() {
    std::set<std::string> wanted;
    for (const auto& [name, made] : now_) wanted.insert(made.files.begin(), made.files.end());
    for (const auto& [name, made] : before_)
      for (const std::string& file : made.files)
        if (std::error_code error; !wanted.count(file) && fs::remove(site_ / file, error)) {
          result_.removed.push_back((site_ / file).string());
          // Removes empty folders. For other folders `remove` fails.
          for (fs::path above = (site_ / file).parent_path(); above != site_ && fs::remove(above, error);)
            above = above.parent_path();
        }
  }

  fs::path folder_, site_;
  const ReportConfig& options_;
  Written& written_;
  Written silent_{[](const std::string&) {}, {}};
  const std::string maker_ = site_maker(options_);
  SiteRecord before_, now_;
  std::set<std::string> whole_;  ///< names of archives whose pages exist
  SiteResult result_;
};

}  // namespace

bool holds_a_study(const fs::path& folder) {
  return is_study_folder(folder) || fs::is_regular_file(folder / "study.h5");
}

std::vector<fs::path> archives_below(const fs::path& folder) {
  std::vector<fs::path> names;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied);
  for (const fs::recursive_directory_iterator end; entry != end; ++entry) {
    std::error_code error;
    const fs::path& path = entry->path();
    const bool hidden = path.filename().string().front() == '.', below = entry->is_directory(error);
    if (below && (hidden || holds_a_study(path))) entry.disable_recursion_pending();
    if (hidden) continue;
    if (below ? holds_a_study(path) : path.extension() == ".h5" && entry->is_regular_file(error))
      names.push_back(path.lexically_relative(folder));
  }
  std::sort(names.begin(), names.end());
  return names;
}

SiteResult report_folder(const fs::path& folder, const fs::path& site, const ReportConfig& options, Written& written) {
  Site made(folder, site, options, written);
  if (made.is_new() && archives_below(folder).empty())
    throw ConfigurationError(fmt::format("{}: the folder has no archive (*.h5) and no study", folder.string()));
  return made.write();
}

}  // namespace modebank::app::report
