#pragma once

#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace modebank::test {

/// The labels at the start of a screen's lines, such as "read" or "structure". They are in the first ten columns.
/// Tables, which begin with a column "filter", have no labels.
inline std::set<std::string> labels_of(const std::string& screen) {
  const std::regex label("^([a-z]+) +(?=\\S)");
  std::set<std::string> labels;
  std::istringstream lines(screen);
  std::smatch found;
  for (std::string line; std::getline(lines, line) && !line.starts_with("filter ");)
    if (std::regex_search(line, found, label) && found.length() == 10) labels.insert(found[1]);
  return labels;
}

}  // namespace modebank::test
