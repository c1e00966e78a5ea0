#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace modebank::app {

/// Named locks among the processes that work on one study, on one machine or over a network file system: each name is a
/// byte of one lock file (POSIX record locks, by the name's SHA-256). The kernel releases what a killed process held.
/// A process has one object of these and its locks do not pass on to children.
///
/// They save work and nothing else: a file system may have none, or keep those of each machine to itself without a
/// word. Where a lock is refused for such a reason its name counts as free, which is said once; results are right
/// without any.
class FileLocks {
 public:
  /// Creates the file if need be. Throws DataError, also when something other than a regular file has its name.
  explicit FileLocks(const std::filesystem::path& path);
  ~FileLocks();
  FileLocks(const FileLocks&) = delete;
  FileLocks& operator=(const FileLocks&) = delete;

  /// Holds a name until it goes.
  class Hold {
   public:
    Hold() = default;
    Hold(const FileLocks* locks, long long place) : locks_(locks), place_(place) {}
    Hold(Hold&& other) noexcept : locks_(std::exchange(other.locks_, nullptr)), place_(other.place_) {}
    Hold& operator=(Hold&& other) noexcept {
      std::swap(locks_, other.locks_);
      std::swap(place_, other.place_);
      return *this;
    }
    ~Hold();
    explicit operator bool() const { return locks_ != nullptr; }

   private:
    const FileLocks* locks_ = nullptr;
    long long place_ = 0;
  };

  /// Empty when another process holds the name.
  Hold try_lock(const std::string& name) const;
  /// Waits for it.
  Hold lock(const std::string& name) const;
  /// Whether another process holds it.
  bool is_held_elsewhere(const std::string& name) const;

 private:
  /// What one gets where there are no locks (errno says why): the name, with the others.
  Hold without_lock(long long place) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace modebank::app
