#pragma once

#include <sys/types.h>

#include <cstdint>
#include <ctime>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/view/child.hpp"

namespace modebank::app::view {

/// Which content a file had when it was looked at.
struct FileState {
  dev_t device = 0;
  ino_t inode = 0;
  std::uintmax_t bytes = 0;
  std::int64_t changed_ns = 0;
  bool operator==(const FileState&) const = default;
};

struct Entry {
  std::string id;              ///< in addresses: digits that depend on the name alone, so that bookmarks stay
  std::filesystem::path name;  ///< relative to the folder
  FileState state;
  nlohmann::json digest;  ///< null until it is read
  std::string problem;    ///< why it could not be
  bool asked = false;     ///< somebody reads the digest of this content

  bool open() const { return digest.is_null() && problem.empty(); }
};

/// The archives (*.h5) of a folder and of those below it. No link is followed, neither when looking nor when opening,
/// so that nothing outside can be reached, also while somebody exchanges folders for links.
class Catalogue {
 public:
  static constexpr int deepest = 4;               ///< folders below each other; a study keeps its archives in the first
  static constexpr std::size_t largest = 20'000;  ///< archives; more are left out

  /// A folder, or one archive. Throws ConfigurationError when there is nothing such.
  explicit Catalogue(const std::filesystem::path& what);

  bool is_one_archive() const { return !only_.empty(); }
  const std::string& title() const { return title_; }

  /// Looks at the folder anew; what has not changed keeps its digest.
  void look();
  /// By id; each change of what is there, or known of it, changes version().
  std::map<std::string, Entry>& entries() { return entries_; }
  const Entry* find(const std::string& id) const;
  std::uint64_t version() const { return version_; }
  void changed() { ++version_; }
  bool cut() const { return cut_; }

  /// For reading; without a file where it is gone or no longer a regular file.
  NamedFile open(const Entry& entry) const;

 private:
  void look_into(int folder, const std::filesystem::path& name, int depth, std::map<std::string, Entry>& found);
  void take(int folder, const std::filesystem::path& name, std::map<std::string, Entry>& found);

  OpenFile root_;
  std::filesystem::path only_;  ///< the one archive's name; empty: all
  std::string title_;
  std::map<std::string, Entry> entries_;
  std::uint64_t version_ = 1;
  bool cut_ = false;
};

}  // namespace modebank::app::view
