#include "app/config/option_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "io/import/expression.hpp"

namespace modebank::app {
namespace {

template <class Number>
Number parse_number(const std::string& text, const char* kind) {
  const std::string trimmed = boost::trim_copy(text);
  Number value{};
  const char* end = trimmed.data() + trimmed.size();
  const auto [stop, error] = std::from_chars(trimmed.data(), end, value);
  if (trimmed.empty() || error != std::errc() || stop != end)
    throw std::invalid_argument(fmt::format("is not {}", kind));
  return value;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  if (boost::trim_copy(text).empty()) return parts;
  boost::split(parts, text, [separator](char c) { return c == separator; });
  for (std::string& part : parts) boost::trim(part);
  return parts;
}

template <class Number>
std::vector<Number> parse_list(const std::string& text) {
  std::vector<Number> values;
  for (const std::string& part : split(text, ',')) {
    Number value{};
    parse_value(part, value);
    values.push_back(value);
  }
  return values;
}

Eigen::VectorXd to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

void parse_value(const std::string& text, std::string& value) { value = text; }

void parse_value(const std::string& text, bool& value) {
  if (text != "true" && text != "false") throw std::invalid_argument("is neither true nor false");
  value = text == "true";
}

void parse_value(const std::string& text, int& value) { value = parse_number<int>(text, "a whole number"); }
void parse_value(const std::string& text, std::uint64_t& value) {
  value = parse_number<std::uint64_t>(text, "a whole number, 0 or more");
}
void parse_value(const std::string& text, Eigen::Index& value) {
  value = parse_number<Eigen::Index>(text, "a whole number");
}
void parse_value(const std::string& text, double& value) {
  value = parse_number<double>(text, "a number");
  if (!std::isfinite(value)) throw std::invalid_argument("is not a finite number");
}

void parse_value(const std::string& text, std::optional<double>& value) {
  value.reset();
  if (!boost::trim_copy(text).empty()) parse_value(text, value.emplace());
}

/// Names separated by commas. A name that contains a comma is in single quotes. A quote inside such a name is doubled,
/// as in data.derive.
void parse_value(const std::string& text, std::vector<std::string>& value) {
  value.clear();
  std::string_view rest = text;
  if (boost::trim_copy(text).empty()) return;
  for (bool more = true; more;) {
    while (!rest.empty() && (rest.front() == ' ' || rest.front() == '\t')) rest.remove_prefix(1);
    std::string_view behind = rest;
    std::string name = rest.starts_with('\'') ? take_channel_name(behind) : std::string();
    const std::size_t comma = behind.find(',');
    const bool quoted = !name.empty() && boost::trim_copy(std::string(behind.substr(0, comma))).empty();
    const std::size_t end = quoted ? comma : rest.find(',');
    if (!quoted) name = boost::trim_copy(std::string(rest.substr(0, end)));
    value.push_back(std::move(name));
    if (quoted) rest = behind;
    more = end != std::string_view::npos;
    if (more) rest.remove_prefix(end + 1);
  }
}
void parse_value(const std::string& text, std::vector<double>& value) { value = parse_list<double>(text); }

void parse_value(const std::string& text, std::vector<Eigen::Index>& value) {
  value.clear();
  for (const std::string& part : split(text, ',')) {
    const auto dots = part.find("..");
    Eigen::Index first = 0, last = 0;
    parse_value(part.substr(0, dots), first);
    last = first;
    if (dots != std::string::npos) parse_value(part.substr(dots + 2), last);
    Eigen::Index span = 0;
    if (__builtin_sub_overflow(last, first, &span) || span < 0 || span > 10'000)
      throw std::invalid_argument("is not a range such as 1..12");
    for (Eigen::Index k = 0; k <= span; ++k) value.push_back(first + k);
  }
  if (value.empty()) throw std::invalid_argument("is empty");
}

void parse_value(const std::string& text, InputDelays& value) {
  std::vector<Eigen::Index> listed;
  parse_value(text, listed);
  value = InputDelays(listed);
}

void parse_value(const std::string& text, Eigen::VectorXd& value) { value = to_vector(parse_list<double>(text)); }

void parse_value(const std::string& text, std::vector<Eigen::VectorXd>& value) {
  value.clear();
  for (const std::string& part : split(text, '|')) value.push_back(to_vector(parse_list<double>(part)));
}

void parse_value(const std::string& text, Eigen::MatrixXd& value) {
  std::vector<Eigen::VectorXd> rows;
  parse_value(text, rows);
  value.resize(static_cast<Eigen::Index>(rows.size()), rows.empty() ? 0 : rows.front().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != value.cols()) throw std::invalid_argument("has rows of different lengths");
    value.row(static_cast<Eigen::Index>(i)) = rows[i];
  }
}

std::string format_value(const std::string& value) { return value; }
std::string format_value(bool value) { return value ? "true" : "false"; }
std::string format_value(int value) { return std::to_string(value); }
std::string format_value(std::uint64_t value) { return std::to_string(value); }
std::string format_value(Eigen::Index value) { return std::to_string(value); }
std::string format_value(double value) { return fmt::format("{}", value); }
std::string format_value(const std::optional<double>& value) { return value ? format_value(*value) : ""; }
std::string format_value(const std::vector<std::string>& value) { return listed_channel_names(value); }
std::string format_value(const std::vector<double>& value) { return fmt::format("{}", fmt::join(value, ", ")); }

std::string format_value(const std::vector<Eigen::Index>& value) {
  const bool range = value.size() > 1 && value.back() - value.front() + 1 == static_cast<Eigen::Index>(value.size()) &&
                     std::is_sorted(value.begin(), value.end());
  return range ? fmt::format("{}..{}", value.front(), value.back()) : fmt::format("{}", fmt::join(value, ", "));
}

std::string format_value(const InputDelays& value) { return fmt::format("{}", fmt::join(value.listed(), ", ")); }
std::string format_value(const Eigen::VectorXd& value) {
  return format_value(std::vector<double>(value.begin(), value.end()));
}

std::string format_value(const std::vector<Eigen::VectorXd>& value) {
  std::vector<std::string> parts;
  for (const Eigen::VectorXd& part : value) parts.push_back(format_value(part));
  return boost::join(parts, " | ");
}

std::string format_value(const Eigen::MatrixXd& value) {
  std::vector<Eigen::VectorXd> rows;
  for (Eigen::Index i = 0; i < value.rows(); ++i) rows.emplace_back(value.row(i));
  return format_value(rows);
}

}  // namespace modebank::app
