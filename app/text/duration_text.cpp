#include "app/text/duration_text.hpp"

#include <fmt/format.h>

namespace modebank::app {

std::string duration_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.3g} min", seconds / 60.0);
  return fmt::format("{:.3g} h", seconds / 3600.0);
}

std::string rate_text(double per_second) {
  return per_second >= 0.1 ? fmt::format("{:.3g} per s", per_second) : fmt::format("{:.3g} per h", 3600.0 * per_second);
}

}  // namespace modebank::app
