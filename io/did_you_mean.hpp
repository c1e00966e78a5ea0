#pragma once

#include <string>
#include <vector>

#include "ident/nearest_name.hpp"

namespace modebank {

/// ", did you mean NAME?", or nothing when no known name is near.
inline std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? std::string() : ", did you mean " + nearest + "?";
}

}  // namespace modebank
