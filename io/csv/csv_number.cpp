#include "io/csv/csv_number.hpp"

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <locale>

#include "ident/base/characters.hpp"

namespace modebank {

namespace {

/// The blanks that spreadsheets use as thousands separators: no-break, narrow no-break and thin blanks.
constexpr std::string_view wide_blanks[]{"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89"};

/// Length in bytes of a thousands separator at the start of the text. 0 if there is none.
std::size_t group_mark(std::string_view text, char mark) {
  if (text.empty()) return 0;
  if (text.front() == mark || text.front() == ' ' || text.front() == '\'') return 1;
  for (const std::string_view blank : wide_blanks)
    if (text.starts_with(blank)) return blank.size();
  return 0;
}

struct Grouped {
  std::string digits;     ///< the number without thousands separators and with a decimal point
  std::size_t marks = 0;  ///< number of thousands separators
  bool has_decimals = false;
};

/// Parses one to three digits, then groups of three digits after thousands separators, then decimals.
std::optional<Grouped> grouped(std::string_view field, char decimal, char mark) {
  std::string_view rest = without_blanks(field);
  Grouped result;
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) {
    if (rest.front() == '-') result.digits = "-";
    rest.remove_prefix(1);
  }
  const auto take_digits = [&](std::size_t most) {
    std::size_t count = 0;
    while (count < std::min(most, rest.size()) && is_digit(rest[count])) ++count;
    result.digits += rest.substr(0, count);
    rest.remove_prefix(count);
    return count;
  };
  const bool leads_with_zero = rest.starts_with('0');
  if (take_digits(3) == 0) return std::nullopt;
  while (const std::size_t bytes = group_mark(rest, mark)) {
    rest.remove_prefix(bytes);
    if (take_digits(3) != 3) return std::nullopt;
    ++result.marks;
  }
  const bool ends_in_group = rest.empty() || !is_digit(rest.front());
  if (result.marks > 0 && (leads_with_zero || !ends_in_group)) return std::nullopt;
  result.has_decimals = rest.starts_with(decimal);
  if (result.has_decimals) {
    result.digits += '.';
    rest.remove_prefix(1);
  }
  const bool has_exponent = rest.find_first_of("eE") != std::string_view::npos;
  if (result.marks > 0 && !result.has_decimals && has_exponent)
    return std::nullopt;  // in 2.499e3 the point is a decimal mark
  result.digits += rest;  // only decimals and an exponent may follow; parse_number checks them
  return result;
}

}  // namespace

std::string commas_as_points(std::string_view field) {
  std::string text(field);
  std::replace(text.begin(), text.end(), ',', '.');
  return text;
}

CsvNumbers::CsvNumbers(bool decimal_comma, const std::vector<std::string>& missing)
    : decimal_comma_(decimal_comma), words_(missing) {
  for (const std::string& word : words_)
    if (const ParsedNumber number = parse_number(word); number.status == NumberStatus::ok)
      values_.push_back(number.value);
}

std::optional<std::string> CsvNumbers::with_point(std::string_view field) const {
  constexpr std::string_view marks_of_comma_files = ".' \xC2\xE2";
  if (decimal_comma_ && field.find_first_of(marks_of_comma_files) == std::string_view::npos)
    return commas_as_points(field);
  std::optional<Grouped> number = grouped(field, decimal_comma_ ? ',' : '.', decimal_comma_ ? '.' : ',');
  if (number && number->marks > 0) {
    const bool either =
        !decimal_comma_ && number->marks == 1 && !number->has_decimals && field.find(',') != std::string_view::npos;
    return either ? std::nullopt : std::optional(std::move(number->digits));
  }
  if (!decimal_comma_ || field.find('.') != std::string_view::npos) return std::nullopt;
  return commas_as_points(field);
}

ParsedNumber CsvNumbers::parse(std::string_view field) const {
  const bool marked = decimal_comma_ && field.find_first_of(".,") != std::string_view::npos;
  ParsedNumber parsed = marked ? ParsedNumber{0.0, NumberStatus::text} : parse_number(field);
  if (parsed.status == NumberStatus::text) {
    if (missing_word(field) != nullptr) return {0.0, NumberStatus::missing};
    if (const std::optional<std::string> number = with_point(field)) parsed = parse_number(*number);
  }
  if (parsed.status == NumberStatus::ok && std::find(values_.begin(), values_.end(), parsed.value) != values_.end())
    return {0.0, NumberStatus::missing};
  return parsed;
}

const std::string* CsvNumbers::missing_word(std::string_view field) const {
  field = without_blanks(field);
  for (const std::string& word : words_)
    if (word.size() == field.size() && boost::algorithm::iequals(word, field, std::locale::classic())) return &word;
  if (values_.empty()) return nullptr;
  const std::optional<std::string> number = with_point(field);
  const ParsedNumber value = parse_number(number ? std::string_view(*number) : field);
  for (const std::string& word : words_)
    if (const ParsedNumber missing = parse_number(word);
        value.status == NumberStatus::ok && missing.status == NumberStatus::ok && missing.value == value.value)
      return &word;
  return nullptr;
}

MarkShown mark_shown(std::string_view field) {
  const auto commas = std::count(field.begin(), field.end(), ','), points = std::count(field.begin(), field.end(), '.');
  if (commas + points == 0) return MarkShown::none;
  const bool comma = CsvNumbers(true, {}).parse(field).status == NumberStatus::ok,
             point = CsvNumbers(false, {}).parse(field).status == NumberStatus::ok;
  if (comma && point) return MarkShown::either_point;
  if (comma && points == 0) {
    const std::optional<Grouped> thousands = grouped(field, '.', ',');
    const bool whole = thousands && thousands->marks == 1 && !thousands->has_decimals &&
                       parse_number(thousands->digits).status == NumberStatus::ok;
    return whole ? MarkShown::either_comma : MarkShown::comma;
  }
  return comma ? MarkShown::comma : point ? MarkShown::point : MarkShown::none;
}

}  // namespace modebank
