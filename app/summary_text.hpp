#pragma once

#include <array>
#include <string>

#include "io/archive.hpp"

namespace modebank::app {

/// Windows by how their fits ended, for those that are not in memory.
struct WindowCounts {
  std::array<Index, 4> status{};  ///< by FitStatus
  void add(const WindowFits& fits);
};

/// What the summary says of windows: how many, how they ended, the global model, and the batch solver's audit.
std::string windows_text(const WindowFits& common, const WindowCounts& counts);
std::string data_text(const Recording& recording);

/// Empty, or what the audit found above tolerance.
std::string audit_warning(const WindowFits& fits);

/// The summary of an archive as people read it: data, windows, mixture, bank, scores and what the bank gains.
std::string summary_text(const Archive& archive);

/// Where the archive comes from.
std::string provenance_text(const Archive& archive);

/// The candidates table, the chosen one marked.
std::string candidates_text(const MixtureResult& mixture);

/// What windows say of the parameters: medians over the windows of estimate, standard error and t value, R^2 and AIC.
std::string window_parameters_text(const WindowFits& fits);

/// How the bank's modes were used on the held-out runs (without any: the training runs), and whether they are
/// calibrated.
std::string mode_diagnostics_text(const Archive& archive);

/// One line per mode: parameters, noise, weight. `full_form` prints I + A instead of A.
std::string modes_text(const Bank& bank, bool full_form);

}  // namespace modebank::app
