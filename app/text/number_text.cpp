#include "app/text/number_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace modebank::app {

std::string fixed_or_short(double value, int decimals) {
  constexpr double largest_fixed = 1e5;
  return std::abs(value) < largest_fixed || std::isnan(value) ? fmt::format("{:.{}f}", value, decimals)
                                                              : fmt::format("{:.4g}", value);
}

}  // namespace modebank::app
