#include "app/init/file_sets.hpp"

#include <algorithm>
#include <cctype>

#include "app/init/survey.hpp"
#include "io/import/file_patterns.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using Path = std::filesystem::path;

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// The common length of these names, shortened to the end of a word in every name.
std::size_t whole_words(const std::vector<std::string>& names, std::size_t common) {
  while (common > 0 && in_word(names.front()[common - 1]) &&
         std::any_of(names.begin(), names.end(),
                     [common](const std::string& name) { return common < name.size() && in_word(name[common]); }))
    --common;
  return common;
}

std::size_t common_start(const std::vector<std::string>& names) {
  std::size_t common = 0;
  const auto shared = [&](const std::string& name) {
    return name.substr(0, common + 1) == names.front().substr(0, common + 1);
  };
  while (common < names.front().size() && std::ranges::all_of(names, shared)) ++common;
  return whole_words(names, common);
}

void find_pattern(FileSet& set) {
  std::sort(set.files.begin(), set.files.end());
  const Path& first = set.files.front();
  for (const Path& file : set.files) set.runs.push_back(file.stem().string());
  if (set.files.size() == 1) {
    set.pattern = first.string();
    return;
  }
  std::vector<std::string> names;
  for (const Path& file : set.files) {
    if (file.parent_path() != first.parent_path()) return;
    names.push_back(file.filename().string());
  }
  const std::string pattern = common_pattern(names);
  if (pattern.empty()) return;
  const std::string whole = (first.parent_path() / pattern).string();
  const FilePattern matcher("files", "", whole);
  const std::vector<std::string> runs = matcher.runs();
  const bool exact = runs.size() == set.files.size() && std::all_of(runs.begin(), runs.end(), [&](const auto& run) {
                       return std::ranges::count(set.files, matcher.path_of(run)) > 0;
                     });
  if (!exact) return;
  set.pattern = whole;
  set.runs = runs;
}

bool is_of_a_kind(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  const auto shared =
      std::count_if(a.begin(), a.end(), [&](const std::string& name) { return std::ranges::count(b, name) > 0; });
  // Two instruments of a robot may share a column name (the frame of a gyro and of an odometry). Their files still
  // differ in kind.
  return 5 * shared >= 4 * std::ssize(a) && 5 * shared >= 4 * std::ssize(b);
}

}  // namespace

std::string typed_path(const Path& path) {
  const Path below = path.lexically_relative(std::filesystem::current_path());
  return (below.empty() || *below.begin() == ".." ? path : below).string();
}

std::string common_pattern(const std::vector<std::string>& names) {
  std::vector<std::string> backwards = names;
  for (std::string& name : backwards) std::reverse(name.begin(), name.end());
  const std::size_t start = common_start(names);
  std::size_t end = common_start(backwards);
  for (const std::string& name : names) end = std::min(end, name.size() > start ? name.size() - start - 1 : 0);
  if (start + end == 0 || names.front().find('*') != std::string::npos) return {};
  return names.front().substr(0, start) + "*" + names.front().substr(names.front().size() - end);
}

std::vector<FileSet> file_sets(const std::vector<std::string>& files) {
  std::vector<FileSet> sets;
  std::vector<std::vector<std::string>> columns;
  for (const std::string& file : files) {
    const Path path = std::filesystem::absolute(file).lexically_normal();
    const std::vector<std::string> own = all_columns(path);
    const auto known =
        std::find_if(columns.begin(), columns.end(), [&](const auto& of) { return is_of_a_kind(of, own); });
    const auto at = static_cast<std::size_t>(known - columns.begin());
    if (known == columns.end()) {
      columns.push_back(own);
      sets.emplace_back();
    }
    if (std::ranges::count(sets[at].files, path) == 0) sets[at].files.push_back(path);
  }
  for (FileSet& set : sets) find_pattern(set);
  return sets;
}

}  // namespace modebank::app
