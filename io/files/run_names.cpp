#include "io/files/run_names.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

void check_run_names(const std::vector<std::string>& names) {
  constexpr std::string_view level_or_end("/\0", 2);
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (std::any_of(name.begin(), name.end(), is_control))
      throw DataError("\"" + printable(name) + "\" cannot name a run: it contains a control character");
    if (name.empty() || name == "." || name == ".." || name == "*" ||
        name.find_first_of(level_or_end) != std::string::npos)
      throw DataError(
          "\"" + name +
          "\" cannot name a run: a name must not be empty, '*', '.' or '..', nor contain '/' or a zero byte");
    if (!seen.insert(name).second) throw DataError("two runs are named \"" + name + "\"");
  }
}

}  // namespace modebank
