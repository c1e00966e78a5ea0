#include "app/text/duration_text.hpp"

#include <fmt/format.h>

#include <regex>

namespace modebank::app {

std::string duration_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.3g} min", seconds / 60.0);
  return fmt::format("{:.3g} h", seconds / 3600.0);
}

std::string rate_text(double per_second) {
  return per_second >= 0.1 ? fmt::format("{:.3g} per s", per_second) : fmt::format("{:.3g} per h", 3600.0 * per_second);
}

std::string in_samples(const std::string& config, const std::string& text) {
  static const std::regex no_times(R"(\ntime = *\n)"), seconds(R"((\d) s\b)");
  const bool invented = std::regex_search(config, no_times) && config.find("\nrate_hz = 1\n") != std::string::npos;
  return invented ? std::regex_replace(text, seconds, "$1 samples") : text;
}

}  // namespace modebank::app
