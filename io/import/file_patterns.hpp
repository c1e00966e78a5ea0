#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A path with at most one `*`, in the file's or in one folder's name. `*` stands for one or more characters of that
/// name (none of them '/'; no leading '.' where the name begins with `*`, as in a shell); every other character is
/// meant literally. The text it matched names the run; without `*` the file's stem does.
class FilePattern {
 public:
  /// `key` names the pattern in messages. A relative pattern is prefixed by `root`. Throws ConfigurationError for an
  /// empty pattern and for more than one `*`.
  FilePattern(std::string key, const std::string& root, const std::string& pattern);

  const std::string& key() const { return key_; }
  bool has_star() const { return has_star_; }
  /// The absolute pattern.
  std::string text() const { return path_of("*").string(); }
  /// The file of one run.
  std::filesystem::path path_of(std::string_view run) const;
  /// Names of all runs whose file exists, in byte order. Throws ConfigurationError, naming the absolute pattern (and
  /// the folder that is missing), when there is none.
  std::vector<std::string> runs() const;

 private:
  bool matches(std::string_view name) const;
  [[noreturn]] void fail_unmatched() const;

  std::string key_;
  bool has_star_ = false;
  std::filesystem::path folder_;  // before the name with the star; the whole path without one
  std::string before_, after_;    // the star, in that name
  std::filesystem::path rest_;    // after that name
};

/// What a key says of files: one path with at most one *, or several without, of one run each ("a.csv, b.csv"); in
/// either case a run's recording may be given in parts that were written one after the other ("a_0.bag + a_1.bag").
class RunFiles {
 public:
  struct File {
    std::string run;
    std::vector<std::filesystem::path> parts;  ///< one, or those of a recording
  };

  /// A file whose name holds a comma is one where it exists. Throws ConfigurationError as FilePattern does, and for a
  /// list with a *, with an empty entry or with two files of the same stem.
  RunFiles(const std::string& key, const std::string& root, const std::string& text);

  bool one() const { return entries_.size() == 1 && !entries_.front().front().has_star(); }
  /// In byte order of their runs. Throws ConfigurationError for what is not there.
  std::vector<File> files() const;
  /// The file of each of these runs; of a list the one that stands where `theirs` names the run. Throws
  /// ConfigurationError, naming both, when one is missing and when a * or a list stands against something else.
  std::vector<File> partners(const RunFiles& theirs, const std::vector<std::string>& runs) const;

 private:
  std::vector<File> listed() const;

  std::string key_;
  std::vector<std::vector<FilePattern>> entries_;  // of each file its parts
};

/// The states file of each run. Throws ConfigurationError, naming both files, when one is missing, and when only one
/// of the two patterns has a `*`.
std::vector<std::filesystem::path> find_partners(const FilePattern& inputs, const FilePattern& states,
                                                 const std::vector<std::string>& runs);

}  // namespace modebank
