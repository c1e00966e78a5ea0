#include "app/cli/log/log_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>

#include "app/config/config_file.hpp"
#include "ident/base/natural_order.hpp"
#include "ident/base/printable.hpp"
#include "io/recording/split_recording.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace fs = std::filesystem;

namespace {

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

/// The logs in a folder, in natural order: folders that are recordings, and files with the extension of a log. A text
/// file counts as a log only if there are no other logs, because it may be a description of the logs.
std::vector<std::string> logs_in(const fs::path& folder) {
  std::vector<std::string> logs, texts;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (is_hidden(path)) continue;
    if (entry.is_directory() ? is_recording_folder(path) : has_ending_of_logs(path)) logs.push_back(path.string());
    if (entry.is_regular_file() && path.extension() == ".txt") texts.push_back(path.string());
  }
  if (logs.empty()) logs = std::move(texts);
  if (logs.empty())
    throw ConfigurationError(
        fmt::format("{}: a folder without logs; expected files that end in .csv, .tsv, .dat, .txt, .mat or .hdf5, or "
                    "recordings (metadata.yaml, .bag, .mcap, .db3)",
                    printable_name(folder.string())));
  std::sort(logs.begin(), logs.end(), natural_less);
  return logs;
}

/// Replaces a folder of logs by its logs.
std::vector<std::string> without_folders(const std::vector<std::string>& logs) {
  std::vector<std::string> files;
  for (const std::string& log : logs)
    if (fs::is_directory(log) && !is_recording_folder(log))
      for (std::string& file : logs_in(log)) files.push_back(std::move(file));
    else
      files.push_back(log);
  return files;
}

}  // namespace

std::vector<FileSet> nameable_sets(const std::vector<std::string>& logs) {
  std::vector<FileSet> sets = file_sets(without_folders(logs));
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
  const fs::path path = first.pattern.empty() ? first.files.front() : fs::path(first.pattern);
  std::string stem = path.stem().string();
  stem = stem.substr(0, stem.find('*'));
  while (!stem.empty() && (stem.back() == '_' || stem.back() == '-' || stem.back() == '.')) stem.pop_back();
  const std::string folder = path.parent_path().filename().string();
  return !stem.empty() ? stem : folder.empty() ? "log" : folder;
}

std::vector<fs::path> files_of(const std::vector<FileSet>& sets) {
  std::vector<fs::path> files;
  for (const FileSet& set : sets) files.insert(files.end(), set.files.begin(), set.files.end());
  return files;
}

}  // namespace modebank::app
