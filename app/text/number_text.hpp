#pragma once

#include <string>

namespace modebank::app {

/// `value` with so many decimals where that fits a column, else with four significant digits: 0.03480, 1.235e+15.
std::string fixed_or_short(double value, int decimals);

/// The same for several, separated by spaces.
template <class Values>
std::string fixed_or_short_list(const Values& values, int decimals) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + fixed_or_short(value, decimals);
  return text;
}

}  // namespace modebank::app
