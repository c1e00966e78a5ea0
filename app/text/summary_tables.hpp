#pragma once

#include <string>

#include "io/archive/archive.hpp"

/// Tables of the summary and of `show`. Columns beyond `width` continue below; 0: no limit.
namespace modebank::app {

/// Pooled scores of every filter, training and held-out runs.
std::string scores_text(const Archive& archive, int width = 0);

/// The table of candidates, with the chosen one marked.
std::string candidates_text(const MixtureResult& mixture, int width = 0);

/// Statistics of the parameters over the windows: median estimate, standard error and t value, R^2 and AIC.
std::string window_parameters_text(const Archive& archive, int width = 0);

/// Use and calibration of the bank's modes on the held-out runs, or on training runs if none is held out.
std::string mode_diagnostics_text(const Archive& archive, int width = 0);

/// The equations of the nonlinear motion, and the share of judged samples outside its training ranges.
std::string equations_text(const Archive& archive, int width = 0);
/// One line per mode: parameters, noise, weight. `full_form` prints I + A instead of A.
std::string modes_text(const Archive& archive, bool full_form, int width = 0);

}  // namespace modebank::app
