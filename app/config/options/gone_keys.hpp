#pragma once

#include <string>

namespace modebank::app {

/// The end of a sentence on a key or value of earlier versions: that it went, and its replacement; empty for others.
/// `value`: empty where the key alone is asked for.
std::string instead_of_gone(const std::string& key, const std::string& value = {});

}  // namespace modebank::app
