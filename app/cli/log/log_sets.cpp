#include "app/cli/log/log_sets.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string/trim.hpp>

#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace fs = std::filesystem;

std::vector<FileSet> nameable_sets(const std::vector<std::string>& logs) {
  std::vector<FileSet> sets = file_sets(logs);
  for (const fs::path& file : files_of(sets)) {
    const std::string name = file.filename().string();
    if (name_holds_controls(name) || boost::trim_copy(name) != name || name.find_first_of("#,*") != std::string::npos)
      throw ConfigurationError(
          fmt::format("{}: no configuration can name it: it holds a comma, a '#', a '*', a blank at an end or a "
                      "control character; rename it",
                      printable_name(file.string())));
  }
  return sets;
}

std::string name_after(const std::vector<FileSet>& sets) {
  const FileSet& first = sets.front();
  std::string stem = (first.pattern.empty() ? first.files.front() : fs::path(first.pattern)).stem().string();
  stem = stem.substr(0, stem.find('*'));
  while (!stem.empty() && (stem.back() == '_' || stem.back() == '-' || stem.back() == '.')) stem.pop_back();
  return stem.empty() ? "log" : stem;
}

std::vector<fs::path> files_of(const std::vector<FileSet>& sets) {
  std::vector<fs::path> files;
  for (const FileSet& set : sets) files.insert(files.end(), set.files.begin(), set.files.end());
  return files;
}

}  // namespace modebank::app
