#include "io/table/number.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <system_error>

#include "ident/base/printable.hpp"

namespace modebank {

namespace {

/// from_chars reports underflow and overflow in the same way. A wider type distinguishes them. strtod would depend on
/// the locale.
ParsedNumber parse_extreme(std::string_view number) {
  long double wide = 0.0L;
  const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), wide);
  const auto value = static_cast<double>(wide);
  return {value, error != std::errc() || std::isinf(value) ? NumberStatus::out_of_range : NumberStatus::ok};
}

/// A fast path for fields that contain only a finite number. Nearly all fields are of this kind.
bool parse_plain(std::string_view field, double& value) {
  const auto [stop, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && stop == field.data() + field.size() && std::isfinite(value);
}

/// Truth values of Python (True), R (TRUE) and JSON (true).
ParsedNumber parse_truth(std::string_view word) {
  for (const std::string_view written : {"true", "True", "TRUE"})
    if (word == written) return {1.0, NumberStatus::ok};
  for (const std::string_view written : {"false", "False", "FALSE"})
    if (word == written) return {0.0, NumberStatus::ok};
  return {0.0, NumberStatus::text};
}

}  // namespace

std::string_view without_blanks(std::string_view field) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = field.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return field.substr(first, field.find_last_not_of(blanks) - first + 1);
}

ParsedNumber parse_number(std::string_view field) {
  ParsedNumber parsed;
  if (parse_plain(field, parsed.value)) return parsed;
  std::string_view number = without_blanks(field);
  if (number.empty()) return {0.0, NumberStatus::missing};
  if (number.size() > 1 && number[0] == '+' && number[1] != '-') number.remove_prefix(1);
  const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), parsed.value);
  if (error == std::errc::invalid_argument) return parse_truth(number);
  const std::string_view rest(stop, static_cast<std::size_t>(number.data() + number.size() - stop));
  for (const std::string_view word : {"#QNAN", "#SNAN", "#IND", "#INF"})  // 1.#QNAN, from C on Windows
    if (rest.starts_with(word)) return {0.0, NumberStatus::missing};
  if (!rest.empty()) return {0.0, NumberStatus::text};
  if (error == std::errc::result_out_of_range) return parse_extreme(number);
  if (!std::isfinite(parsed.value)) parsed.status = NumberStatus::missing;
  return parsed;
}

std::string shown_field(std::string_view field) {
  constexpr std::size_t shown_bytes = 60;
  return fmt::format("\"{}\"{}", printable_name(field.substr(0, shown_bytes)), field.size() > shown_bytes ? "..." : "");
}

std::string unusable_number(NumberStatus status, std::string_view field) {
  if (status == NumberStatus::out_of_range) return shown_field(field) + " is too large for a double";
  return field.empty() ? "missing value" : fmt::format("missing value ({})", shown_field(field));
}

}  // namespace modebank
