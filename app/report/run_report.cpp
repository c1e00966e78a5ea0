#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "app/commands.hpp"
#include "app/config_file.hpp"
#include "app/report/gnuplot.hpp"
#include "app/report/run_figures.hpp"
#include "app/report/run_page.hpp"
#include "app/report/write_page.hpp"
#include "ident/error.hpp"
#include "io/archive.hpp"

namespace modebank::app {
namespace {

/// Where the page goes: -o, else the archive's name with .html in the current folder.
std::filesystem::path page_path(const CommandLine& line) {
  if (!line.output.empty()) return line.output;
  std::filesystem::path named = std::filesystem::path(line.files.front()).lexically_normal();
  if (!named.has_filename()) named = named.parent_path();
  return named.stem().string() + ".html";
}

/// Figures of one archive; prints what was written and what could not be.
void write_figures(const Archive& archive, const ReportConfig& options) {
  const report::FigureSet set = report::run_figures(archive, options.run);
  const auto files = report::draw_figures(set.figures, {options.figures, options.png, options.sources});
  fmt::print("{}: {}\n", options.figures, fmt::join(files, ", "));
  for (const std::string& reason : set.left_out) fmt::print("left out: {}\n", reason);
}

void report_run(const CommandLine& line, const ReportConfig& options) {
  const std::filesystem::path file = line.files.front();
  // Figures alone, unless a page is asked for.
  const bool with_page = options.figures.empty() || !line.output.empty();
  if (with_page) report::check_page_path(page_path(line), {file});
  const Archive archive = read_archive(file);
  if (!options.figures.empty()) write_figures(archive, options);
  if (with_page) report::write_page(page_path(line), report::run_page(archive, file.filename().string(), options));
}

}  // namespace

int run_report(const CommandLine& line) {
  if (line.files.empty() || line.files.size() > 2)
    throw ConfigurationError(
        "report needs an archive, a study's folder, or two archives to compare: modebank report ARCHIVE [ARCHIVE] [-o "
        "page.html]");
  const ReportConfig options = stored_config("", line.overrides).report;
  const bool one_run = line.files.size() == 1 && !report::is_study(line.files.front());
  if (!one_run && !options.figures.empty()) throw ConfigurationError("report.figures are drawn of one archive");
  if (line.files.size() == 2)
    report::report_comparison(line.files[0], line.files[1], page_path(line), options);
  else if (one_run)
    report_run(line, options);
  else
    report::report_study(line.files.front(), page_path(line), options);
  return 0;
}

}  // namespace modebank::app
