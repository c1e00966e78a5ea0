#pragma once

#include <string>
#include <vector>

#include "app/text/warnings.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

std::string data_text(const Recording& recording);

/// The summary of an archive as people read it: data, windows, mixture, bank, scores and what the bank gains. Lines
/// longer than `width` columns are broken; 0: none.
std::string summary_text(const Archive& archive, int width = 0);

/// Where the archive comes from.
std::string provenance_text(const Archive& archive);

}  // namespace modebank::app
