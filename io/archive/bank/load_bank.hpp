#pragma once

#include <functional>
#include <string>

#include "filter/step/bank.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// Reads one bank of an archive: "bank" or the competitor "baseline", "noise_only", "one_motion", "drifting" or
/// "nonlinear". The other parts of the file are not decoded. Throws DataError if the archive has no such bank.
Bank load_bank(const OpenArchive& archive, const std::string& which = "bank");

class GroupReader;
/// Calls `body` with the root group of an archive. Error messages contain the archive's path.
void read_root(const OpenArchive& archive, const std::function<void(GroupReader&)>& body);

/// The resolved configuration from which an archive was made.
std::string load_configuration(const OpenArchive& archive);

/// The hash of the data from which an archive was made.
std::string load_data_hash(const OpenArchive& archive);

}  // namespace modebank
