#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// The value because of which a column is text, with the key that helps: the first value that begins like a number,
/// else the first of all. Empty if all values are equal.
std::string why_no_numbers(const std::vector<std::string>& texts);

}  // namespace modebank::app
