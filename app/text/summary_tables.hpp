#pragma once

#include <string>

#include "io/archive/archive.hpp"

/// The tables of the summary and of `show`. A table wider than `width` columns goes on below; 0: no limit.
namespace modebank::app {

/// Pooled scores of every filter, training and held-out runs.
std::string scores_text(const Archive& archive, int width = 0);

/// The candidates table, the chosen one marked.
std::string candidates_text(const MixtureResult& mixture, int width = 0);

/// What windows say of the parameters: medians over the windows of estimate, standard error and t value, R^2 and AIC.
std::string window_parameters_text(const Archive& archive, int width = 0);

/// How the bank's modes were used on the held-out runs (without any: the training runs), and whether they are
/// calibrated.
std::string mode_diagnostics_text(const Archive& archive, int width = 0);

/// The equations of the archive's motion that bends, and how many judged samples lie outside of its training ranges.
std::string equations_text(const Archive& archive, int width = 0);
/// One line per mode: parameters, noise, weight. `full_form` prints I + A instead of A.
std::string modes_text(const Archive& archive, bool full_form, int width = 0);

}  // namespace modebank::app
