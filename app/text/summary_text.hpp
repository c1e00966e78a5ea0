#pragma once

#include <string>

#include "app/text/number_text.hpp"
#include "app/text/warnings.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

std::string data_text(const Recording& recording);

/// The summary of an archive for people: data, windows, mixture, bank, scores and the bank's gains. Lines longer than
/// `width` columns are broken. 0 means no limit.
std::string summary_text(const Archive& archive, const std::string& unit, int width = 0);

/// The archive's provenance as text.
std::string provenance_text(const Archive& archive);

}  // namespace modebank::app
