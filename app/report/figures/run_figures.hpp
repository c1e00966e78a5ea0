#pragma once

#include <string>
#include <vector>

#include "app/report/figures/figure.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// The figures that an archive holds the numbers for, and in words those it does not.
struct FigureSet {
  std::vector<Figure> figures;
  std::vector<std::string> left_out;
};

/// Content of Salvi et al. (arXiv 2505.00200), figure 2b: local_models; 3: estimates; 4: nis; 5: coverage. Beside them:
/// prediction (inputs, state, 95 % band), selection, pit, transition (graph of the switches). `run`: whose time series
/// are drawn; empty: the first that was held out. Throws ConfigurationError for a run that the archive does not hold.
FigureSet run_figures(const Archive& archive, const std::string& run);

// Its parts; each adds to the set.
void add_window_figures(const Archive& archive, FigureSet& set);
void add_time_figures(const Archive& archive, const std::string& run, FigureSet& set);
void add_score_figures(const Archive& archive, FigureSet& set);

void add_transition_figure(const Archive& archive, FigureSet& set);

/// "bank, 3 modes".
std::string bank_title(const Archive& archive);
/// Null without.
const FilterEvaluation* evaluation_of(const Archive& archive, const std::string& filter);

}  // namespace modebank::app::report
