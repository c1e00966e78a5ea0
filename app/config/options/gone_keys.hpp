#pragma once

#include <string>

namespace modebank::app {

/// What takes the place of a key or value of earlier versions, as the end of a sentence on it (": use KEY"); empty for
/// others. `value`: empty where the key alone is asked for.
std::string instead_of_gone(const std::string& key, const std::string& value = {});

}  // namespace modebank::app
