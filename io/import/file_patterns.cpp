#include "io/import/file_patterns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "io/table/number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Path = std::filesystem::path;

bool is_there(const Path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

/// The first part of `path`, from the root on, that does not exist.
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
    throw ConfigurationError(
        fmt::format("{} = {}: there are {} stars, but at most one * is allowed", key_, pattern, stars));
  has_star_ = stars == 1;
  const Path start = root.empty() ? std::filesystem::current_path() : std::filesystem::absolute(root);
  if (!has_star_) {
    folder_ = (start / pattern).lexically_normal();
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "drive/" means the recording "drive"
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
    throw ConfigurationError(fmt::format("{} = {} and {} = {}: put a * into both or neither", inputs.key(),
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

RunFiles::RunFiles(const std::string& key, const std::string& root, const std::string& text) : key_(key) {
  const FilePattern whole(key, root, text.find('*') == text.rfind('*') ? text : text.substr(0, text.find(',')));
  const bool is_file = !whole.has_star() && is_there(whole.path_of(""));
  std::vector<std::string> listed{text};
  if (!is_file) boost::split(listed, text, boost::is_any_of(","));
  for (const std::string& entry : listed) {
    const std::string name(is_file ? std::string_view(entry) : without_blanks(entry));
    if (name.empty() && !text.empty()) throw ConfigurationError(fmt::format("{} = {}: an entry is empty", key, text));
    entries_.emplace_back(key, root, name);
    if (entries_.back().has_star() && text != entry)
      throw ConfigurationError(
          fmt::format("{} = {}: a list cannot contain a *; give one path with a *, or a list of files", key, text));
  }
}

std::vector<RunFiles::File> RunFiles::listed() const {
  std::vector<File> files;
  for (const FilePattern& entry : entries_) {
    const std::string run = entry.runs().front();
    const File file{run, entry.path_of(run)};
    for (const File& other : files)
      if (other.run == file.run)
        throw ConfigurationError(fmt::format("{}: {} and {} would both have the run name {}", key_, other.path.string(),
                                             file.path.string(), file.run));
    files.push_back(file);
  }
  return files;
}

std::vector<RunFiles::File> RunFiles::files() const {
  const FilePattern& first = entries_.front();
  std::vector<File> files;
  if (first.has_star())
    for (const std::string& run : first.runs()) files.push_back({run, first.path_of(run)});
  else
    files = listed();
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.run < b.run; });
  return files;
}

std::vector<RunFiles::File> RunFiles::partners(const RunFiles& theirs, const std::vector<std::string>& runs) const {
  const FilePattern &own = entries_.front(), &other = theirs.entries_.front();
  std::vector<File> partners;
  if (entries_.size() == 1 && theirs.entries_.size() == 1) {
    const std::vector<Path> paths = find_partners(other, own, runs);
    for (std::size_t i = 0; i < runs.size(); ++i) partners.push_back({runs[i], paths[i]});
    return partners;
  }
  if (entries_.size() != theirs.entries_.size() || own.has_star() || other.has_star())
    throw ConfigurationError(
        fmt::format("{} lists {} files, but {} lists {}; list the same number in the same order, or use a * in both",
                    theirs.key_, theirs.entries_.size(), key_, entries_.size()));
  const std::vector<File> all = theirs.listed(), here = listed();
  for (const std::string& run : runs)
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].run == run) partners.push_back({run, here[i].path});
  return partners;
}

}  // namespace modebank
