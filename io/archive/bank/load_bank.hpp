#pragma once

#include <functional>
#include <string>

#include "filter/step/bank.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// One bank of an archive: "bank" or the competitor "baseline", "noise_only", "one_motion", "drifting" or "nonlinear".
/// Decodes nothing else of the file. Throws DataError when the archive has no such bank.
Bank load_bank(const OpenArchive& archive, const std::string& which = "bank");

class GroupReader;
/// Calls `body` with the root of an archive; messages contain its path.
void read_root(const OpenArchive& archive, const std::function<void(GroupReader&)>& body);

/// The resolved configuration from which an archive was made.
std::string load_configuration(const OpenArchive& archive);

/// The hash of the data from which it was made.
std::string load_data_hash(const OpenArchive& archive);

}  // namespace modebank
