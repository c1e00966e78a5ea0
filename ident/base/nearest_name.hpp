#pragma once

#include <string>
#include <vector>

namespace modebank {

/// The known name with the smallest edit distance (Levenshtein 1966) to `name`, or that `name` abbreviates; empty when
/// none is within a third of its length (at least 2 edits). For messages that say what the user may have meant.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

/// ", did you mean NAME?", or nothing when no known name is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

}  // namespace modebank
