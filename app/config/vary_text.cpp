#include "app/config/vary_text.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <cmath>
#include <stdexcept>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/config/option_text.hpp"

namespace modebank::app {
namespace {

constexpr double most_values = 100'000;

std::vector<std::string> words_between(const std::string& text, const char* separators) {
  std::vector<std::string> words;
  boost::split(words, text, boost::is_any_of(separators));
  for (std::string& word : words) boost::trim(word);
  return words;
}

const Option& variable_option(const std::string& key) {
  const Option* option = find_option(key);
  if (!option) throw std::invalid_argument(fmt::format("names an unknown key {}{}", key, nearest_key_hint(key)));
  if (!option->stage) throw std::invalid_argument(fmt::format("varies {}, which changes no number of a run", key));
  return *option;
}

/// The value in the form that a resolved configuration has.
std::string canonical(const Option& option, const std::string& value) {
  Config scratch;
  try {
    option.set(scratch, value);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(
        fmt::format("gives {} the value '{}', which {} (allowed: {})", option.key, value, error.what(), option.range));
  }
  return option.get(scratch);
}

double number_in(const std::string& text, const std::string& braces) {
  double value = 0.0;
  try {
    parse_value(text, value);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(fmt::format(
        "has {{{}}}; expected a range such as {{3..12}}, {{2..20 step 2}}, {{0..1 lin 5}} or {{0.001..1 log 7}}",
        braces));
  }
  return value;
}

/// A range in braces: low..high, and how it is divided.
struct Span {
  double low = 0.0, high = 0.0, argument = 0.0;
  std::string kind;  ///< how the span is divided: "step", "lin", "log" or empty
  bool has_argument = false;
};

bool is_whole(double value) { return value == std::floor(value); }

Span parse_span(const std::string& text) {
  const auto dots = text.find("..");
  if (dots == std::string::npos) number_in("", text);
  std::vector<std::string> words;
  const std::string rest = boost::trim_copy(text.substr(dots + 2));
  boost::split(words, rest, boost::is_any_of(" \t"), boost::token_compress_on);
  Span span;
  span.low = number_in(text.substr(0, dots), text);
  span.high = number_in(words[0], text);
  if (words.size() > 1) span.kind = words[1];
  if (words.size() > 2) span.argument = number_in(words[2], text);
  span.has_argument = words.size() > 2;
  const bool known = span.kind.empty() || span.kind == "step" || span.kind == "lin" || span.kind == "log";
  if (!known || words.size() > 3 || (span.kind == "step" && !span.has_argument)) number_in("", text);
  if (!(span.low < span.high))
    throw std::invalid_argument(fmt::format("has {{{}}}; the first number must be the smaller one", text));
  if (span.kind == "log" && span.low <= 0.0)
    throw std::invalid_argument(fmt::format("has {{{}}}: a logarithmic range must be above 0", text));
  return span;
}

bool is_open(const Span& span) {
  return span.kind.empty() ? !is_whole(span.low) || !is_whole(span.high) : !span.has_argument;
}

std::vector<std::string> steps_of(const Span& span, const std::string& text) {
  const double step = span.kind == "step" ? span.argument : 1.0;
  if (!(step > 0.0) || (span.high - span.low) / step > most_values)
    throw std::invalid_argument(
        fmt::format("has {{{}}}: a step must be above 0 and give at most {} values", text, most_values));
  std::vector<std::string> values;
  const double slack = 1e-9;  // tolerance for rounding, so that 0..1 step 0.1 ends at 1
  for (double i = 0; span.low + i * step <= span.high + slack * step; ++i)
    values.push_back(fmt::format("{:.12g}", span.low + i * step));
  return values;
}

std::vector<std::string> divisions_of(const Span& span, const std::string& text) {
  const double count = span.argument;
  if (!is_whole(count) || count < 2 || count > most_values)
    throw std::invalid_argument(
        fmt::format("has {{{}}}: the number of values must be whole, 2 to {}", text, most_values));
  std::vector<std::string> values;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double share = i / (count - 1);
    const double value = span.kind == "log" ? span.low * std::pow(span.high / span.low, share)
                                            : span.low + (span.high - span.low) * share;
    values.push_back(fmt::format("{:.12g}", value));
  }
  return values;
}

std::vector<std::string> expand_piece(const std::string& piece) {
  const auto open = piece.find('{'), close = piece.find('}');
  if (open == std::string::npos && close == std::string::npos) return {piece};
  if (open == std::string::npos || close == std::string::npos || close < open ||
      piece.find('{', open + 1) != std::string::npos)
    throw std::invalid_argument(fmt::format("has '{}'; a value takes one pair of braces", piece));
  const std::string text = piece.substr(open + 1, close - open - 1);
  const Span span = parse_span(text);
  if (is_open(span))
    throw std::invalid_argument(fmt::format("has {{{}}}; add a number of values (lin N, log N or step S)", text));
  std::vector<std::string> values =
      span.kind == "lin" || span.kind == "log" ? divisions_of(span, text) : steps_of(span, text);
  for (std::string& value : values) value = piece.substr(0, open) + value + piece.substr(close + 1);
  return values;
}

/// Reads a value that is a range without a number of values, such as {0.001..1 log}.
bool read_range(const std::string& text, VariedKey& varied) {
  if (text.size() < 2 || text.front() != '{' || text.back() != '}' || text.find('|') != std::string::npos) return false;
  const Span span = parse_span(text.substr(1, text.size() - 2));
  if (!is_open(span)) return false;
  varied.low = span.low;
  varied.high = span.high;
  varied.logarithmic = span.kind == "log";
  return true;
}

/// Splits a line at the equal sign into the key and the text after it.
std::pair<std::string, std::string> split_equation(const std::string& line) {
  const auto equal = line.find('=');
  if (equal == std::string::npos) throw std::invalid_argument("has no =");
  return {boost::trim_copy(line.substr(0, equal)), boost::trim_copy(line.substr(equal + 1))};
}

}  // namespace

VariedKey parse_vary(const std::string& line) {
  VariedKey varied;
  std::string text;
  std::tie(varied.key, text) = split_equation(line);
  const Option& option = variable_option(varied.key);
  if (read_range(text, varied)) {
    for (const double end : {varied.low, varied.high, varied.low + (varied.high - varied.low) / std::sqrt(2.0)})
      canonical(option, format_value(end));
    return varied;
  }
  for (const std::string& piece : words_between(text, "|"))
    for (const std::string& value : expand_piece(piece)) varied.values.push_back(canonical(option, value));
  return varied;
}

std::vector<std::string> parse_together(const std::string& line) {
  std::vector<std::string> keys = words_between(line, ",");
  for (const std::string& key : keys) variable_option(key);
  if (keys.size() < 2) throw std::invalid_argument("names fewer than two keys");
  return keys;
}

}  // namespace modebank::app
