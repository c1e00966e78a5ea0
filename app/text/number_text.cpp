#include "app/text/number_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace modebank::app {

std::string fixed_or_short(double value, int decimals) {
  constexpr double largest_fixed = 1e5;
  constexpr int many = 4;  // a value that is rounded to fewer decimals may print as 0
  const bool vanishes = decimals >= many && value != 0.0 && std::abs(value) < 0.5 * std::pow(10.0, -decimals);
  const bool fixed = (std::abs(value) < largest_fixed && !vanishes) || std::isnan(value);
  return fixed ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.4g}", value);
}

std::string size_text(double value, int decimals) {
  constexpr double least = 10.0;  // a significand of two digits
  const bool tiny = value > 0.0 && value * std::pow(10.0, decimals) < least;
  return tiny ? fmt::format("{:.3g}", value) : fixed_or_short(value, decimals);
}

std::string estimate_text(double value, double standard_error, const char* plus_minus) {
  constexpr int most_decimals = 12;
  if (!std::isfinite(value) || !std::isfinite(standard_error) || standard_error <= 0.0)
    return fmt::format("{:.4g}", value);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(standard_error)));
  if (decimals > most_decimals || decimals < 0)
    return fmt::format("{:.4g} {} {:.2g}", value, plus_minus, standard_error);
  return fmt::format("{:.{}f} {} {:.{}f}", value, decimals, plus_minus, standard_error, decimals);
}

}  // namespace modebank::app
