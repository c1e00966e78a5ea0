#pragma once

#include <string>
#include <vector>

namespace modebank {

/// The known name nearest to `name` by edit distance (Levenshtein 1966), or the known name that `name` abbreviates.
/// Empty if every known name needs more than max(2, a third of the length of `name`) edits. Used in messages with
/// suggestions.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

/// ", did you mean NAME?"; empty if no known name is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

}  // namespace modebank
