#include "io/import/file_patterns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Path = std::filesystem::path;

bool is_there(const Path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

/// The part of `path` that is missing first, seen from the root.
Path first_missing(const Path& path) {
  Path reached;
  for (const Path& part : path) {
    reached /= part;
    if (!is_there(reached)) break;
  }
  return reached;
}

}  // namespace

FilePattern::FilePattern(std::string key, const std::string& root, const std::string& pattern) : key_(std::move(key)) {
  if (pattern.empty()) throw ConfigurationError(fmt::format("{} is not set", key_));
  const auto stars = std::count(pattern.begin(), pattern.end(), '*');
  if (stars > 1)
    throw ConfigurationError(fmt::format("{} = {}: {} stars, but at most one * is allowed", key_, pattern, stars));
  has_star_ = stars == 1;
  const Path start = root.empty() ? std::filesystem::current_path() : std::filesystem::absolute(root);
  if (!has_star_) {
    folder_ = (start / pattern).lexically_normal();
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "drive/" is the recording "drive"
    return;
  }
  bool after_star = false;
  Path folder = start;
  for (const Path& part : Path(pattern)) {
    const std::string name = part.string();
    const std::size_t star = name.find('*');
    if (star != std::string::npos) {
      before_ = name.substr(0, star);
      after_ = name.substr(star + 1);
      after_star = true;
    } else {
      (after_star ? rest_ : folder) /= part;
    }
  }
  folder_ = folder.lexically_normal();
}

Path FilePattern::path_of(std::string_view run) const {
  if (!has_star_) return folder_;
  const Path named = folder_ / fmt::format("{}{}{}", before_, run, after_);
  return rest_.empty() ? named : named / rest_;
}

bool FilePattern::matches(std::string_view name) const {
  return name.size() > before_.size() + after_.size() && name.starts_with(before_) && name.ends_with(after_) &&
         !(before_.empty() && name.front() == '.');
}

std::vector<std::string> FilePattern::runs() const {
  std::vector<std::string> names;
  std::error_code error;
  if (!has_star_ && is_there(folder_)) names.push_back(folder_.stem().string());
  if (has_star_)
    for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end;
         entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      if (!matches(name)) continue;
      std::string run = name.substr(before_.size(), name.size() - before_.size() - after_.size());
      if (rest_.empty() || is_there(path_of(run))) names.push_back(std::move(run));
    }
  if (names.empty()) fail_unmatched();
  std::sort(names.begin(), names.end());
  return names;
}

void FilePattern::fail_unmatched() const {
  const Path folder = has_star_ ? folder_ : folder_.parent_path();
  if (!is_there(folder))
    throw ConfigurationError(
        fmt::format("{}: no file matches {}: {} does not exist", key_, text(), first_missing(folder).string()));
  std::error_code error;
  std::filesystem::directory_iterator opened(folder, error);
  throw ConfigurationError(
      fmt::format("{}: no file matches {}{}", key_, text(), error ? ": " + error.message() : std::string()));
}

std::vector<Path> find_partners(const FilePattern& inputs, const FilePattern& states,
                                const std::vector<std::string>& runs) {
  if (inputs.has_star() != states.has_star())
    throw ConfigurationError(fmt::format("{} = {} and {} = {}: both or neither must have a *", inputs.key(),
                                         inputs.text(), states.key(), states.text()));
  std::vector<Path> partners;
  for (const std::string& run : runs) {
    partners.push_back(states.path_of(run));
    if (!is_there(partners.back()))
      throw ConfigurationError(fmt::format("{} has no states file: {} does not exist", inputs.path_of(run).string(),
                                           partners.back().string()));
  }
  return partners;
}

}  // namespace modebank
