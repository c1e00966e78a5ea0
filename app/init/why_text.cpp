#include "app/init/why_text.hpp"

#include <fmt/format.h>

#include <set>

#include "ident/base/printable.hpp"
#include "io/csv/csv_number.hpp"

namespace modebank::app {

std::string why_no_numbers(const std::vector<std::string>& texts) {
  const std::string *like_number = nullptr, *first = nullptr;
  bool numbers = false;
  std::size_t changes = 0;
  for (const std::string& text : texts) {
    const NumberStatus status = parse_number(text).status;
    numbers = numbers || status == NumberStatus::ok;
    changes += &text != &texts.front() && text != *(&text - 1) ? 1 : 0;
    if (status != NumberStatus::text) continue;
    if (first == nullptr) first = &text;
    if (like_number == nullptr && text.find_first_of("0123456789") < 2) like_number = &text;
  }
  if (first == nullptr || changes == 0) return "";
  const std::string& text = like_number != nullptr ? *like_number : *first;
  constexpr std::size_t longest = 30;
  const MarkShown mark = like_number != nullptr ? mark_shown(text) : MarkShown::none;
  const bool comma = mark == MarkShown::comma || mark == MarkShown::either_comma;
  std::string hint;
  if (comma || mark == MarkShown::either_point)
    hint = fmt::format(": other numbers have a decimal {} (data.decimal)", comma ? "point" : "comma");
  else if (numbers)
    hint = ", although other values are (data.na lists words for missing values)";
  else if (2 * changes > texts.size() && 10 * std::set(texts.begin(), texts.end()).size() < texts.size())
    hint = changing_text;
  return fmt::format("\"{}\" is not a number{}", printable_name(text.substr(0, longest)), hint);
}

}  // namespace modebank::app
