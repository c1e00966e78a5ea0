#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// The value that keeps a column of text from being one of numbers, with its mark of decimals or the key that helps:
/// the first that begins like a number, else the first of all. Empty: all values are equal.
std::string why_no_numbers(const std::vector<std::string>& texts);

}  // namespace modebank::app
