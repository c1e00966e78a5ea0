#include "app/report/page/write_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/figures/gnuplot.hpp"
#include "io/files/output_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {

void check_page_path(const std::filesystem::path& path, const std::vector<std::filesystem::path>& sources) {
  constexpr std::size_t front_bytes = 100;
  check_output({"-o", path, form_by_front("a page", "<!DOCTYPE html>", front_bytes)}, sources);
}

void write_page(const std::filesystem::path& path, const Page& page, Written& written) {
  constexpr double bytes_per_MB = 1e6;
  const std::string html = html_of(page);
  replace_file(path, {html});
  written.files.push_back(path.string());
  written.say(fmt::format("{}: {:.1f} MB; open it in a browser\n", path.string(),
                          static_cast<double>(html.size()) / bytes_per_MB));
}

namespace {

FigureOptions figure_options(const ReportConfig& options) { return {options.figures, options.png, options.sources}; }

}  // namespace

void check_figures(const FigureSet& set, const ReportConfig& options,
                   const std::vector<std::filesystem::path>& sources) {
  check_figure_files(set.figures, figure_options(options), sources);
}

void write_figures(const FigureSet& set, const ReportConfig& options, Written& written) {
  const DrawnFigures drawn = draw_figures(set.figures, figure_options(options));
  for (const std::string& file : drawn.files)
    written.files.push_back((std::filesystem::path(options.figures) / file).string());
  if (!drawn.files.empty()) written.say(fmt::format("{}: {}\n", options.figures, fmt::join(drawn.files, ", ")));
  for (const std::string& reason : set.left_out) written.say(fmt::format("left out: {}\n", reason));
  if (!drawn.failed.empty())
    throw DataError(fmt::format("report.figures: {} of {} figures could not be drawn, the others are there\n{}",
                                drawn.failed.size(), set.figures.size(), fmt::join(drawn.failed, "\n")));
}

}  // namespace modebank::app::report
