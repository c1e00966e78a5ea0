#include "app/report/site/report_folder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/report/page/run_page.hpp"
#include "app/report/site/index_row.hpp"
#include "app/study/space/study_plan.hpp"
#include "ident/base/printable.hpp"
#include "io/archive/archive.hpp"
#include "io/files/output_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* index_mark = R"(<meta name="generator" content="modebank report">)";

/// The path of a page as an address.
std::string address_of(const std::string& path) {
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  std::string address;
  for (const char c : path)
    address += plain.find(c) != std::string_view::npos ? std::string(1, c)
                                                       : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return address;
}

std::string index_html(const std::string& folder, const std::vector<IndexRow>& rows) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{}\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{} · modebank</title>\n"
      "<style>:root {{ color-scheme: light dark; font-family: sans-serif; }} th, td {{ text-align: left; padding: "
      ".2rem .8rem .2rem 0; "
      "}}</style>\n</head>\n<body>\n<h1>{}</h1>\n<table>\n"
      "<tr><th>Archive</th><th>Data</th><th>What was found</th><th>Made (UTC)</th></tr>\n",
      index_mark, escaped_html(folder), escaped_html(folder));
  for (const IndexRow& row : rows) {
    const std::string name = escaped_html(printable(row.name));
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        row.page.empty() ? name : fmt::format("<a href=\"{}\">{}</a>", address_of(row.page), name),
                        escaped_html(printable(row.data)), escaped_html(row.text), escaped_html(row.created));
  }
  return html + "</table>\n</body>\n</html>\n";
}

/// The pages of a folder while `report` works.
class Site {
 public:
  Site(fs::path folder, fs::path site, const ReportConfig& options, Written& written)
      : folder_(std::move(folder)), site_(std::move(site)), options_(options), written_(written) {}

  SiteResult write(const std::vector<fs::path>& names) {
    check_folder();
    make_own_folder(site_);
    // The index comes first, so that the folder is known as a site if this process is killed among the pages.
    if (!fs::exists(index())) replace_file(index(), {index_html(folder_name(), {})});
    std::vector<IndexRow> rows;
    for (const fs::path& name : names) rows.push_back(row_of(name));
    replace_file(index(), {index_html(folder_name(), rows)});
    written_.files.push_back(index().string());
    result_.archives = names.size();
    return result_;
  }

 private:
  fs::path index() const { return site_ / "index.html"; }

  std::string folder_name() const {
    const fs::path path = fs::absolute(folder_).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
  }

  /// A folder that has files needs an index of `report` among them.
  void check_folder() const {
    if (!fs::exists(site_)) return;
    if (!fs::is_directory(site_)) throw ConfigurationError(fmt::format("-o {}: this is not a folder", site_.string()));
    constexpr std::size_t front_bytes = 400;
    const bool ours = fs::is_regular_file(index()) && form_by_front("", index_mark, front_bytes).is_one(index());
    if (!fs::is_empty(site_) && !ours)
      throw ConfigurationError(
          fmt::format("-o {}: the folder has files that report did not write; name a new folder", site_.string()));
  }

  /// The row of the index for an archive. If needed, first makes the archive's pages.
  IndexRow row_of(const fs::path& name) {
    IndexRow row{name.string(), {}, {}, {}, {}};
    try {
      const fs::path path = folder_ / name;
      fs::is_directory(path) ? add_study(name / "study.h5", find_study(path, silent_), row) : add_archive(name, row);
    } catch (const std::exception& error) {
      row.text = printable(error.what());
      if (const std::string path = (folder_ / name).string() + ": "; row.text.rfind(path, 0) == 0)
        row.text.erase(0, path.size());
      result_.problems.emplace_back(name.string(), row.text);
    }
    return row;
  }

  void add_archive(const fs::path& name, IndexRow& row) {
    const OpenArchive archive(folder_ / name);
    if (is_study(archive)) return add_study(name, find_study(archive), row);
    describe(archive, row);
    row.page = page_of(name, true, [&](const fs::path& page, Written& pages) {
      check_page_path(page, {archive.path()});
      const Archive content = read_archive(archive, Evaluations::in_file);
      write_page(page, run_page(content, archive.path().filename().string(), options_), pages);
    });
  }

  void add_study(const fs::path& file, const FoundStudy& study, IndexRow& row) {
    describe(study, row);
    row.page = page_of(file, study.whole,
                       [&](const fs::path& page, Written& pages) { report_study(study, page, options_, pages); });
  }

  /// Address of an archive's page in the site. A page has the time of its archive and is kept while the archive has
  /// this time. `write` makes this page and the pages that belong to it.
  template <class Write>
  std::string page_of(const fs::path& file, bool whole, Write write) {
    const fs::path name = ("pages" / file).replace_extension(".html"), page = site_ / name;
    const auto archive_time = whole ? fs::last_write_time(folder_ / file) : fs::file_time_type::clock::now();
    if (std::error_code error; whole && fs::last_write_time(page, error) == archive_time) return name.string();
    fs::create_directories(page.parent_path());
    Written pages = silent_;
    write(page, pages);
    fs::last_write_time(page, archive_time);
    written_.files.insert(written_.files.end(), pages.files.begin(), pages.files.end());
    return name.string();
  }

  fs::path folder_, site_;
  const ReportConfig& options_;
  Written& written_;
  Written silent_{[](const std::string&) {}, {}};
  SiteResult result_;
};

}  // namespace

bool holds_a_study(const fs::path& folder) {
  return fs::exists(plan_file(folder)) || fs::is_regular_file(folder / "study.h5");
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
  const std::vector<fs::path> names = archives_below(folder);
  if (names.empty())
    throw ConfigurationError(fmt::format("{}: the folder has no archive (*.h5) and no study", folder.string()));
  return Site(folder, site, options, written).write(names);
}

}  // namespace modebank::app::report
