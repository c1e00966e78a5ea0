#pragma once

#include <string>
#include <utility>

#include "modebank/base/error.hpp"

namespace modebank {

/// Calls the library. If this throws a ConfigurationError, adds the section of the configuration to the message. The
/// message begins with the name of an option, so "step = 0 is out of range" becomes "window.step = 0 is out of range".
template <class Call>
auto in_section(const std::string& section, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(section + "." + error.what());
  }
}

}  // namespace modebank
