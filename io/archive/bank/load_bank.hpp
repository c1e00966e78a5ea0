#pragma once

#include <functional>
#include <string>

#include "filter/step/bank.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// One bank of an archive: "bank" or the competitor "baseline", "noise_only", "one_motion", "drifting" or "nonlinear".
/// Nothing else of the file is decoded. Throws DataError when the archive holds no such bank.
Bank load_bank(const OpenArchive& archive, const std::string& which = "bank");

class GroupReader;
/// Runs `body` on the root of an archive; messages name its path.
void read_root(const OpenArchive& archive, const std::function<void(GroupReader&)>& body);

/// The resolved configuration an archive was made with.
std::string load_configuration(const OpenArchive& archive);

/// The hash of the data it was made from.
std::string load_data_hash(const OpenArchive& archive);

}  // namespace modebank
