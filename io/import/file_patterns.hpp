#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A path with at most one `*`, in the name of the file or of one folder. `*` matches one or more characters of that
/// name, but not '/'. As in a shell, a `*` at the start of a name does not match a leading '.'. All other characters
/// are literal. The matched text is the run's name; without `*` the name is the file's stem.
class FilePattern {
 public:
  /// `key` names the pattern in messages. A relative pattern starts at `root`. Throws ConfigurationError if the pattern
  /// is empty or has more than one `*`.
  FilePattern(std::string key, const std::string& root, const std::string& pattern);

  const std::string& key() const { return key_; }
  bool has_star() const { return has_star_; }
  /// The pattern as an absolute path.
  std::string text() const { return path_of("*").string(); }
  /// The file of one run.
  std::filesystem::path path_of(std::string_view run) const;
  /// Names of all runs whose file exists, in byte order. If no file exists, throws ConfigurationError with the absolute
  /// pattern and the missing folder.
  std::vector<std::string> runs() const;

 private:
  bool matches(std::string_view name) const;
  [[noreturn]] void fail_unmatched() const;

  std::string key_;
  bool has_star_ = false;
  std::filesystem::path folder_;  // path before the name that contains `*`; the whole path if there is no `*`
  std::string before_, after_;    // parts of this name before and after `*`
  std::filesystem::path rest_;    // path after this name
};

/// The files of a key. The key has one path with at most one `*`, or one path without `*` for each run ("a.csv,
/// b.csv").
class RunFiles {
 public:
  struct File {
    std::string run;
    std::filesystem::path path;
  };

  /// If a file has the whole text, commas included, as its name, the text means this file. Throws ConfigurationError in
  /// the same cases as FilePattern. Also throws it for a list with a `*`, an empty entry or two files of the same stem.
  RunFiles(const std::string& key, const std::string& root, const std::string& text);

  bool one() const { return entries_.size() == 1 && !entries_.front().has_star(); }
  /// The files in byte order of their runs. Throws ConfigurationError if a file is missing.
  std::vector<File> files() const;
  /// The file of each of these runs. In a list, it is the file at the run's position in `theirs`. Throws
  /// ConfigurationError with both names in two cases: a file is missing, or only one of the two keys is a list or has a
  /// `*`.
  std::vector<File> partners(const RunFiles& theirs, const std::vector<std::string>& runs) const;

 private:
  std::vector<File> listed() const;

  std::string key_;
  std::vector<FilePattern> entries_;
};

/// The states file of each run. Throws ConfigurationError with both files if a file is missing, or if only one of the
/// two patterns has a `*`.
std::vector<std::filesystem::path> find_partners(const FilePattern& inputs, const FilePattern& states,
                                                 const std::vector<std::string>& runs);

}  // namespace modebank
