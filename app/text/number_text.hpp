#pragma once

#include <string>

namespace modebank::app {

/// `value` with so many decimals where that fits a column, else with four significant digits: 0.03480, 1.235e+15.
std::string fixed_or_short(double value, int decimals);

/// Digits down to the second of the standard error: "-0.597 +- 0.031"; four digits and no error where none is known.
std::string estimate_text(double value, double standard_error, const char* plus_minus = "+-");

/// Of a size, as an RMSE is: the same, but three significant digits where so many decimals hold fewer.
std::string size_text(double value, int decimals);

/// The same for several, separated by spaces.
template <class Values>
std::string size_list(const Values& values, int decimals) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + size_text(value, decimals);
  return text;
}

}  // namespace modebank::app
