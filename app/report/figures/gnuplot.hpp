#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/report/figures/figure.hpp"

namespace modebank::app::report {

struct FigureOptions {
  std::filesystem::path folder;  ///< made if it is not there
  bool png = false;              ///< PNG, too
  bool sources = false;          ///< gnuplot scripts and data beside them, to restyle
};

/// Throws ConfigurationError where draw_figures would replace a file that is not of a figure, or is one of `sources`
/// (files that the command reads). A figure's LaTeX snippet and script show that the files beside them are its.
void check_figure_files(const std::vector<Figure>& figures, const FigureOptions& options,
                        const std::vector<std::filesystem::path>& sources);

/// What became of the figures.
struct DrawnFigures {
  std::vector<std::string> files;   ///< their names in the folder
  std::vector<std::string> failed;  ///< "nis.pdf: what gnuplot said"
};

/// Draws every figure with gnuplot as SVG and PDF, writes a LaTeX snippet that includes it, and puts the files of a
/// figure into the folder, all or none: one that cannot be drawn does not lose the others. Throws ConfigurationError
/// when gnuplot is missing or the folder cannot be written.
DrawnFigures draw_figures(const std::vector<Figure>& figures, const FigureOptions& options);

}  // namespace modebank::app::report
