#include "app/text/number_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace modebank::app {

std::string fixed_or_short(double value, int decimals) {
  constexpr double largest_fixed = 1e5;
  constexpr int many = 4;  // with this many decimals or more, a value other than 0 must not print as 0
  const bool vanishes = decimals >= many && value != 0.0 && std::abs(value) < 0.5 * std::pow(10.0, -decimals);
  const bool fixed = (std::abs(value) < largest_fixed && !vanishes) || std::isnan(value);
  return fixed ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.4g}", value);
}

std::string size_text(double value, int decimals) {
  constexpr double least = 10.0;  // for smaller products, `decimals` decimals show fewer than two digits
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

std::string likelihood_words(double nats) {
  constexpr double by_times = 1.2, most_times = 1000.0, most_digits = 10.0;
  constexpr double least_percent = 0.05, most_percent = 99.0;
  const double times = std::exp(nats), share = 100.0 * std::expm1(nats);
  if (times > most_times) return fmt::format("over {:.0f} times as likely", most_times);
  if (times >= most_digits) return fmt::format("{:.0f} times as likely", times);
  if (times >= by_times) return fmt::format("{:.1f} times as likely", times);
  if (std::abs(share) < least_percent) return "as likely";
  if (-share > most_percent) return fmt::format("over {:.0f} % less likely", most_percent);
  return fmt::format("{:.1f} % {} likely", std::abs(share), share > 0.0 ? "more" : "less");
}

std::string with_degrees(double value, const std::string& unit) {
  const std::string text = fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
  if (unit != "rad" && unit != "rad/s") return text;
  return fmt::format("{} ({:.3g} deg{})", text, 180.0 / std::numbers::pi * value, unit.substr(3));
}

std::string counted(std::ptrdiff_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string duration_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.3g} min", seconds / 60.0);
  return fmt::format("{:.3g} h", seconds / 3600.0);
}

std::string rate_text(double per_second) {
  return per_second >= 0.1 ? fmt::format("{:.3g} per s", per_second) : fmt::format("{:.3g} per h", 3600.0 * per_second);
}

std::string time_unit(const std::map<std::string, std::string>& settings) {
  const auto time = settings.find("data.time"), rate = settings.find("data.rate_hz"), none = settings.end();
  return time != none && time->second.empty() && rate != none && rate->second == "1" ? "samples" : "s";
}

}  // namespace modebank::app
