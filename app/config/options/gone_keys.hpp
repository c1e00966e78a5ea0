#pragma once

#include <string>

namespace modebank::app {

/// End of a sentence: the key or value was removed, with its replacement. Empty for keys and values that exist.
/// `value`: the removed value, or empty for the whole key.
std::string instead_of_gone(const std::string& key, const std::string& value = {});

}  // namespace modebank::app
