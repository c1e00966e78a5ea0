#include "io/recording/split_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "ident/base/natural_order.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Path = std::filesystem::path;

std::string unquoted(std::string text) {
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front())
    text = text.substr(1, text.size() - 2);
  return text;
}

/// The entries of `relative_file_paths` in rosbag2's YAML. They are the lines "- NAME" below this key.
std::vector<Path> listed_files(const Path& folder, const Path& list) {
  std::istringstream lines(read_file(list));
  std::vector<Path> files;
  bool listing = false;
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    const std::size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos) continue;
    if (line.compare(first, 20, "relative_file_paths:") == 0) {
      listing = true;
    } else if (listing && line.compare(first, 2, "- ") == 0) {
      const Path name = unquoted(line.substr(first + 2));
      if (name.filename() != name || name == "." || name == "..")
        throw ConfigurationError(fmt::format("{}: {} is not a file in its folder", list.string(), name.string()));
      files.push_back(folder / name);
    } else {
      listing = false;
    }
  }
  if (files.empty())
    throw ConfigurationError(fmt::format("{}: it lists no files under relative_file_paths", list.string()));
  return files;
}

bool has_ending_of_recordings(const Path& file) {
  const Path ending = file.extension();
  return ending == ".bag" || ending == ".mcap" || ending == ".db3";
}

}  // namespace

bool is_recording_folder(const Path& folder) {
  if (std::filesystem::exists(folder / "metadata.yaml")) return true;
  return std::any_of(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator(),
                     [](const auto& entry) { return has_ending_of_recordings(entry.path()); });
}

std::vector<Path> recording_files(const Path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {path};
  if (const Path list = path / "metadata.yaml"; std::filesystem::is_regular_file(list, error))
    return listed_files(path, list);
  std::vector<Path> files;
  std::string ending;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    const std::string own = entry.path().extension().string();
    if (!has_ending_of_recordings(entry.path())) continue;
    if (!ending.empty() && own != ending)
      throw ConfigurationError(
          fmt::format("{}: the folder has both {} and {} files, and no metadata.yaml that lists one recording",
                      path.string(), std::min(own, ending), std::max(own, ending)));
    ending = own;
    files.push_back(entry.path());
  }
  if (files.empty())
    throw ConfigurationError(
        fmt::format("{}: the folder has neither metadata.yaml nor .bag, .mcap or .db3 files", path.string()));
  std::sort(files.begin(), files.end(),
            [](const Path& a, const Path& b) { return natural_less(a.string(), b.string()); });
  return files;
}

}  // namespace modebank
