#pragma once

#include <string>

namespace modebank::app {

/// The end of a sentence on a key or value of earlier versions: that it was removed, and its replacement. Empty for
/// others. `value`: empty means the key alone.
std::string instead_of_gone(const std::string& key, const std::string& value = {});

}  // namespace modebank::app
