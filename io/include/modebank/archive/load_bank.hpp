#pragma once

#include <string>

#include "modebank/filter/bank.hpp"

namespace modebank::archive {

/// One bank of an archive: "bank", or a competitor: "baseline", "noise_only", "one_motion", "drifting", "nonlinear".
/// The archive's hash is checked first, and nothing else of the file is decoded. Throws DataError
/// (modebank/base/error.hpp) for a file that cannot be read, is damaged or has no such bank.
filter::Bank load_bank(const std::string& path, const std::string& which = "bank");

}  // namespace modebank::archive
