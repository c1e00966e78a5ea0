#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/config/option_table.hpp"
#include "app/config/option_text.hpp"

/// What the lines of the option table are written with.
namespace modebank::app {

/// Allowed numbers, in words and as a test.
struct Range {
  std::string text;
  std::function<bool(double)> contains;
};

inline Range any() {
  return {"a number", [](double) { return true; }};
}
inline Range at_least(double low) {
  return {fmt::format(">= {}", low), [low](double v) { return v >= low; }};
}
inline Range above(double low) {
  return {fmt::format("> {}", low), [low](double v) { return v > low; }};
}
inline Range between(double low, double high) {
  return {fmt::format("{} to {}", low, high), [low, high](double v) { return v >= low && v <= high; }};
}
inline Range inside(double low, double high) {
  return {fmt::format("above {} and below {}", low, high), [low, high](double v) { return v > low && v < high; }};
}
inline Range each(Range range) {
  range.text = "each " + range.text;
  return range;
}

template <class T>
requires std::is_arithmetic_v<T>
bool in_range(const Range& range, T value) { return range.contains(static_cast<double>(value)); }
inline bool in_range(const Range& range, const std::optional<double>& value) {
  return !value || range.contains(*value);
}
inline bool in_range(const Range& range, const Eigen::MatrixXd& values) {
  return std::all_of(values.reshaped().begin(), values.reshaped().end(), range.contains);
}
template <class T>
bool in_range(const Range& range, const std::vector<T>& values) {
  return std::all_of(values.begin(), values.end(), [&range](const T& value) { return in_range(range, value); });
}

/// `field` maps a Config to the value, so reading and writing go through one expression.
template <class Field>
Option option(std::string key, std::string range, std::string unit, std::string help, Field field) {
  return {std::move(key),
          std::move(range),
          std::move(unit),
          std::move(help),
          [field](Config& config, const std::string& text) {
            std::decay_t<decltype(field(config))> value = field(config);
            parse_value(text, value);
            field(config) = value;
          },
          [field](const Config& config) { return format_value(field(config)); },
          {}};
}

template <class Field>
Option numeric(std::string key, const Range& range, std::string unit, std::string help, Field field) {
  Option result = option(std::move(key), range.text, std::move(unit), std::move(help), field);
  result.set = [set = result.set, range, field](Config& config, const std::string& text) {
    Config candidate = config;
    set(candidate, text);
    if (!in_range(range, field(candidate))) throw std::invalid_argument("is out of range");
    config = candidate;
  };
  return result;
}

template <class Field>
Option words(std::string key, std::string help, Field field) {
  using E = std::decay_t<decltype(field(std::declval<Config&>()))>;
  return option(std::move(key), words_of<E>(), "", std::move(help), field);
}

template <class Field>
Option flag(std::string key, std::string help, Field field) {
  return option(std::move(key), "true | false", "", std::move(help), field);
}

template <class Field>
Option text(std::string key, std::string what, std::string help, Field field) {
  return option(std::move(key), std::move(what), "", std::move(help), field);
}

/// The member of a Config that an option reads and writes.
#define MODEBANK_FIELD(expression) ([](auto& c) -> auto& { return c.expression; })

}  // namespace modebank::app
