#include "io/run_names.hpp"

#include <fmt/format.h>

#include <set>
#include <string_view>

#include "ident/error.hpp"

namespace modebank {

std::vector<std::string> run_names(const std::vector<Trajectory>& runs) {
  std::vector<std::string> names;
  for (const Trajectory& run : runs) names.push_back(run.run);
  return names;
}

void check_run_names(const std::vector<std::string>& names) {
  constexpr std::string_view level_or_end("/\0", 2);
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty() || name == "." || name == ".." || name == "*" ||
        name.find_first_of(level_or_end) != std::string::npos)
      throw DataError(fmt::format(
          "\"{}\" cannot name a run: a name must not be empty, '*', '.' or '..' nor hold '/' or a zero byte", name));
    if (!seen.insert(name).second) throw DataError(fmt::format("two runs are named \"{}\"", name));
  }
}

}  // namespace modebank
