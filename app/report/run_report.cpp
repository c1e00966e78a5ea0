#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "app/commands.hpp"
#include "app/config_file.hpp"
#include "app/report/gnuplot.hpp"
#include "app/report/run_figures.hpp"
#include "app/report/run_page.hpp"
#include "ident/error.hpp"
#include "io/archive.hpp"
#include "io/replace_file.hpp"

namespace modebank::app {
namespace {

/// Where the page goes: -o, else the archive's name with .html in the current folder.
std::filesystem::path page_path(const CommandLine& line) {
  if (!line.output.empty()) return line.output;
  std::filesystem::path named = std::filesystem::path(line.files.front()).lexically_normal();
  if (!named.has_filename()) named = named.parent_path();
  return named.stem().string() + ".html";
}

void write_page(const std::filesystem::path& path, const report::Page& page) {
  constexpr double bytes_per_MB = 1e6;
  const std::string html = report::html_of(page);
  replace_file(path, {html});
  fmt::print("{}: {:.1f} MB; open it in a browser\n", path.string(), static_cast<double>(html.size()) / bytes_per_MB);
}

/// Figures of one archive; prints what was written and what could not be.
void write_figures(const Archive& archive, const ReportConfig& options) {
  const report::FigureSet set = report::run_figures(archive, options.run);
  const auto files = report::draw_figures(set.figures, {options.figures, options.png, options.sources});
  fmt::print("{}: {}\n", options.figures, fmt::join(files, ", "));
  for (const std::string& reason : set.left_out) fmt::print("left out: {}\n", reason);
}

void check_output(const std::filesystem::path& path, const std::filesystem::path& file) {
  if (const std::string obstacle = write_obstacle(path); !obstacle.empty()) throw ConfigurationError("-o: " + obstacle);
  std::error_code none;
  if (std::filesystem::equivalent(path, file, none))
    throw ConfigurationError(fmt::format("-o: {} is the archive itself", path.string()));
}

}  // namespace

int run_report(const CommandLine& line) {
  if (line.files.size() != 1)
    throw ConfigurationError("report needs one archive: modebank report ARCHIVE [-o page.html]");
  const Config config = stored_config("", line.overrides);
  const ReportConfig& options = config.report;
  const std::filesystem::path file = line.files.front();
  // Figures alone, unless a page is asked for.
  const bool with_page = options.figures.empty() || !line.output.empty();
  if (with_page) check_output(page_path(line), file);
  const Archive archive = read_archive(file);
  if (!options.figures.empty()) write_figures(archive, options);
  if (with_page) write_page(page_path(line), report::run_page(archive, file.filename().string(), options));
  return 0;
}

}  // namespace modebank::app
