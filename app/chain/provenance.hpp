#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank {

/// Program, libraries and time of this execution, the configuration's hash and the command line. The chain adds the
/// data's hash.
Provenance make_provenance(const std::string& config_hash, const std::string& command_line);

}  // namespace modebank
