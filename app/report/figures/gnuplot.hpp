#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/report/figures/figure.hpp"

namespace modebank::app::report {

struct FigureOptions {
  std::filesystem::path folder;  ///< made if it is not there
  bool png = false;              ///< PNG beside the SVG
  bool sources = false;          ///< gnuplot scripts and data beside them, to restyle
};

/// Draws every figure with gnuplot and puts the files into the folder, all or none. Returns their names. Throws
/// ConfigurationError when gnuplot is missing or the folder cannot be written, DataError when gnuplot fails.
std::vector<std::string> draw_figures(const std::vector<Figure>& figures, const FigureOptions& options);

}  // namespace modebank::app::report
