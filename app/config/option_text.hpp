#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "modebank/base/names.hpp"
#include "modebank/ident/input_delays.hpp"

namespace modebank::app {

/// Conversion between text and value, one pair of functions per type. parse_value throws std::invalid_argument with the
/// reason.
void parse_value(const std::string& text, std::string& value);
void parse_value(const std::string& text, bool& value);
void parse_value(const std::string& text, int& value);
void parse_value(const std::string& text, std::uint64_t& value);
void parse_value(const std::string& text, Eigen::Index& value);
void parse_value(const std::string& text, double& value);
void parse_value(const std::string& text, std::optional<double>& value);
void parse_value(const std::string& text, std::vector<std::string>& value);      ///< a, b
void parse_value(const std::string& text, std::vector<double>& value);           ///< 1, 2
void parse_value(const std::string& text, std::vector<Eigen::Index>& value);     ///< "3", "1..12" or "2, 4, 8"
void parse_value(const std::string& text, InputDelays& value);                   ///< 1, 2
void parse_value(const std::string& text, Eigen::VectorXd& value);               ///< 1, 2
void parse_value(const std::string& text, std::vector<Eigen::VectorXd>& value);  ///< "1, 2 | 3, 4"
void parse_value(const std::string& text, Eigen::MatrixXd& value);               ///< rows of the matrix: "1, 2 | 3, 4"

std::string format_value(const std::string& value);
std::string format_value(bool value);
std::string format_value(int value);
std::string format_value(std::uint64_t value);
std::string format_value(Eigen::Index value);
std::string format_value(double value);
std::string format_value(const std::optional<double>& value);
std::string format_value(const std::vector<std::string>& value);
std::string format_value(const std::vector<double>& value);
std::string format_value(const std::vector<Eigen::Index>& value);
std::string format_value(const InputDelays& value);
std::string format_value(const Eigen::VectorXd& value);
std::string format_value(const std::vector<Eigen::VectorXd>& value);
std::string format_value(const Eigen::MatrixXd& value);

/// The alternatives of an enumeration, as text for help.
template <class E>
std::string words_of() {
  std::string words;
  for (const auto word : EnumNames<E>::values) words += (words.empty() ? "" : " | ") + std::string(word);
  return words;
}

template <class E>
requires std::is_enum_v<E>
void parse_value(const std::string& text, E& value) {
  const std::optional<E> parsed = parse_name<E>(text);
  if (!parsed) throw std::invalid_argument("is none of its words");
  value = *parsed;
}

template <class E>
requires std::is_enum_v<E> std::string format_value(E value) { return std::string(name_of(value)); }

}  // namespace modebank::app
