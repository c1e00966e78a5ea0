#pragma once

#include <string>

#include "io/archive/archive.hpp"

/// Tables for the summary and for `show`. Columns beyond `width` continue below. 0 means no limit.
namespace modebank::app {

/// Pooled scores of every filter on training and held-out runs.
std::string scores_text(const Archive& archive, int width = 0);

/// The table of candidates. The chosen candidate is marked.
std::string candidates_text(const MixtureResult& mixture, int width = 0);

/// Use and calibration of the bank's modes on held-out runs, or on training runs if no run is held out.
std::string mode_diagnostics_text(const Archive& archive, int width = 0);

/// The equations of the nonlinear motion, and the share of judged samples outside its training ranges.
std::string equations_text(const Archive& archive, int width = 0);
/// One line per mode: parameters, noise and weight. With `full_form` it prints I + A instead of A.
std::string modes_text(const Archive& archive, bool full_form, int width = 0);

}  // namespace modebank::app
