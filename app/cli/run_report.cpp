#include <fmt/format.h>

#include "app/cli/commands.hpp"
#include "app/config/config_file.hpp"
#include "app/report/page/run_page.hpp"
#include "app/report/page/write_page.hpp"
#include "app/report/site/report_folder.hpp"
#include "io/archive/archive.hpp"
#include "io/files/replace_file.hpp"

namespace modebank::app {
namespace {

/// Whether the command line has a single folder that does not contain a study.
bool is_site(const CommandLine& line) {
  const std::filesystem::path folder = line.files.front();
  return line.files.size() == 1 && std::filesystem::is_directory(folder) && !report::holds_a_study(folder);
}

/// Path of the page or site. Without -o it has the name of the archive or folder and is in the current folder.
std::filesystem::path page_path(const CommandLine& line) {
  if (!line.output.empty()) return line.output;
  std::filesystem::path named = std::filesystem::path(line.files.front()).lexically_normal();
  if (!named.has_filename()) named = named.parent_path();
  return named.stem().string() + (is_site(line) ? "_site" : ".html");
}

void report_run(const OpenArchive& opened, const std::filesystem::path& page, const ReportConfig& options,
                report::Written& written) {
  const std::filesystem::path& file = opened.path();
  report::check_page_path(page, {file});
  const Archive archive = read_archive(opened, Evaluations::in_file);
  report::write_page(page, report::run_page(archive, file.filename().string(), options), written);
}

/// Writes the index of a folder and the pages of its archives.
void report_site(const CommandLine& line, const std::filesystem::path& site, const ReportConfig& options,
                 report::Written& written) {
  const report::SiteResult result = report::report_folder(line.files.front(), site, options, written);
  std::string text = fmt::format("{} archives; {} pages written\n", result.archives, written.files.size() - 1);
  nlohmann::json problems = nlohmann::json::array();
  for (const auto& [file, what] : result.problems) {
    text += fmt::format("no page of {}: {}\n", file, what);
    problems.push_back({{"file", file}, {"what", what}});
  }
  print_text(line, text);
  print_json(line, {{"written", written.files}, {"problems", problems}});
}

/// Writes the page or pages of the files.
void report_files(const CommandLine& line, const std::filesystem::path& page, const ReportConfig& options,
                  report::Written& written) {
  if (line.files.size() > 1) return report::report_comparison(line.files[0], line.files[1], page, written);
  const std::string& name = line.files.front();
  if (std::filesystem::is_directory(name))
    return report::report_study(report::find_study(name, written), page, options, written);
  const OpenArchive file(name);
  if (report::is_study(file))
    report::report_study(report::find_study(file), page, options, written);
  else
    report_run(file, page, options, written);
}

}  // namespace

int run_report(const CommandLine& line) {
  const ReportConfig options = stored_config("", line.overrides).report;
  const std::filesystem::path page = final_target(page_path(line));
  report::Written written{[&](const std::string& text) { print_text(line, text); }, {}};
  if (is_site(line)) {
    report_site(line, page, options, written);
    return 0;
  }
  report_files(line, page, options, written);
  print_json(line, {{"written", written.files}});
  return 0;
}

}  // namespace modebank::app
