#pragma once

#include <string>

namespace modebank::app {

/// `value` with so many decimals where that fits a column, else with four significant digits: 0.03480, 1.235e+15.
std::string fixed_or_short(double value, int decimals);

/// Digits down to the second of the standard error: "-0.597 +- 0.031"; four digits and no error where none is known.
std::string estimate_text(double value, double standard_error, const char* plus_minus = "+-");

/// The same for several, separated by spaces.
template <class Values>
std::string fixed_or_short_list(const Values& values, int decimals) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + fixed_or_short(value, decimals);
  return text;
}

}  // namespace modebank::app
