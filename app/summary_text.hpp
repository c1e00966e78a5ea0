#pragma once

#include <string>

#include "io/archive.hpp"

namespace modebank::app {

/// The summary of an archive as people read it: data, windows, mixture, bank, scores and what the bank gains.
std::string summary_text(const Archive& archive);

/// Where the archive comes from.
std::string provenance_text(const Archive& archive);

/// The candidates table, the chosen one marked.
std::string candidates_text(const MixtureResult& mixture);

/// One line per mode: parameters, noise, weight. `full_form` prints I + A instead of A.
std::string modes_text(const Bank& bank, bool full_form);

}  // namespace modebank::app
