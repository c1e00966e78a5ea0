#include "io/table/name_unit.hpp"

#include "io/table/number.hpp"

namespace modebank {

NameAndUnit split_unit(std::string_view name) {
  const char close = name.empty() ? '\0' : name.back();
  if (close != ']' && close != ')') return {name, {}};
  const std::size_t open = name.rfind(close == ']' ? " [" : " (");
  if (open == std::string_view::npos || open == 0) return {name, {}};
  return {name.substr(0, open), bare_unit(name.substr(open))};
}

std::string_view bare_unit(std::string_view unit) {
  unit = without_blanks(unit);
  const bool in_brackets =
      unit.size() > 1 && ((unit.front() == '[' && unit.back() == ']') || (unit.front() == '(' && unit.back() == ')'));
  return in_brackets ? unit.substr(1, unit.size() - 2) : unit;
}

}  // namespace modebank
