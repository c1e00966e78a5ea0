#pragma once

#include <string>

namespace modebank::app {

/// The end of a sentence on a key or value of earlier versions: it was removed, and this replaces it. Empty for keys
/// and values that exist. `value`: empty means the whole key.
std::string instead_of_gone(const std::string& key, const std::string& value = {});

}  // namespace modebank::app
