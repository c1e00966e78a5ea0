#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/config/option_table.hpp"
#include "app/config/option_text.hpp"

/// Functions that build the rows of the option table.
namespace modebank::app {

/// Argument of touch(): the key is one of the few that most users set.
inline constexpr bool basic = true;

/// A range of numbers: its text for help, and its bounds.
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
inline Range above_to(double low, double high) {
  return {fmt::format("above {} and at most {}", low, high), [low, high](double v) { return v > low && v <= high; }};
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

inline bool in_range(const Range& range, const InputDelays& value) { return in_range(range, value.listed()); }

/// Functions that set and get a member of a Config. They are plain functions, so that their code is compiled once per
/// type and not once per key.
template <class T>
struct Field {
  T& (*in)(Config&);
  const T& (*of)(const Config&);
};
template <class In, class Of>
auto field_of(In in, Of of) {
  using T = std::remove_reference_t<decltype(in(std::declval<Config&>()))>;
  return Field<T>{in, of};
}

/// Makes the Field for a member of Config.
#define MODEBANK_FIELD(member)                                \
  (field_of(                                                  \
      [](Config & config) -> auto& { return config.member; }, \
      [](const Config& config) -> auto& { return config.member; }))

template <class T>
Option option(std::string key, std::string range, std::string unit, std::string help, Field<T> field) {
  return {std::move(key),
          std::move(range),
          std::move(unit),
          std::move(help),
          [field](Config& config, const std::string& text) {
            T value = field.of(config);
            parse_value(text, value);
            field.in(config) = value;
          },
          [field](const Config& config) { return format_value(field.of(config)); },
          {}};
}

template <class T>
Option numeric(std::string key, const Range& range, std::string unit, std::string help, Field<T> field) {
  Option result = option(std::move(key), range.text, std::move(unit), std::move(help), field);
  result.set = [range, field](Config& config, const std::string& text) {
    T value = field.of(config);
    parse_value(text, value);
    if (!in_range(range, value)) throw std::invalid_argument("is out of range");
    field.in(config) = value;
  };
  return result;
}

template <class E>
Option words(std::string key, std::string help, Field<E> field) {
  return option(std::move(key), words_of<E>(), "", std::move(help), field);
}

inline Option flag(std::string key, std::string help, Field<bool> field) {
  return option(std::move(key), "true | false", "", std::move(help), field);
}

template <class T>
Option text(std::string key, std::string what, std::string help, Field<T> field) {
  return option(std::move(key), std::move(what), "", std::move(help), field);
}

/// A key whose value sets several members. The caller fills in `set` and `get`.
inline Option of_several(std::string key, std::string range, std::string unit, std::string help) {
  Option result;
  result.key = std::move(key);
  result.range = std::move(range);
  result.unit = std::move(unit);
  result.help = std::move(help);
  return result;
}

/// A key that may be set in several lines. Its text has one line per value. Setting the key adds these lines; an empty
/// text removes all lines.
inline Option lines(const std::string& key, const std::string& what, const std::string& help,
                    const std::function<void(const std::string&)>& check, Field<std::vector<std::string>> field) {
  Option result;
  result.key = key;
  result.range = what;
  result.help = help + " (repeatable)";
  result.repeatable = true;
  result.set = [field, check](Config& config, const std::string& text) {
    std::vector<std::string>& values = field.in(config);
    if (boost::trim_copy(text).empty()) return values.clear();
    std::vector<std::string> added;
    boost::split(added, text, [](char c) { return c == '\n'; });
    for (const std::string& line : added) {
      check(line);
      values.push_back(boost::trim_copy(line));
    }
  };
  result.get = [field](const Config& config) { return boost::join(field.of(config), "\n"); };
  return result;
}

}  // namespace modebank::app
