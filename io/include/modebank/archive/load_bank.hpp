#pragma once

#include <string>

#include "modebank/filter/bank.hpp"

namespace modebank::archive {

/// Loads one bank of an archive: "bank", or a competitor: "baseline", "noise_only", "one_motion", "drifting",
/// "nonlinear". The archive's hash is checked first; the other parts of the file are not decoded. Throws DataError
/// (modebank/base/error.hpp) if the file cannot be read, is damaged or lacks this bank.
filter::Bank load_bank(const std::string& path, const std::string& which = "bank");

}  // namespace modebank::archive
