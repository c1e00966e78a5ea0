#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace modebank::app {

/// The value that makes a column text, with the key that helps. It is the first value that begins like a number, or the
/// first value if there is none. Empty if all values are equal.
std::string why_no_numbers(const std::vector<std::string>& texts);
inline constexpr std::string_view changing_text = ", and it changes from row to row";  ///< end of such a line

}  // namespace modebank::app
