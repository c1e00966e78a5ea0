#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <optional>

namespace modebank::app {

/// A small file that marks work in progress. It contains the host, number and start time of the process, and a time. A
/// thread renews this time every minute during the work.
/// - A claim ends when its process on this host is gone, or when it was not renewed for ten minutes. It also ends if
///   its time is ten minutes in the future, because then the clock was set back.
/// - Times are the times of files written in the folder, because machines that share a folder have different clocks.
/// - The next process takes the claim over by renaming a file.
///
/// Claims only prevent that work is done twice. After a long pause, or on a file system without hard links, two
/// processes may hold the same claim. Both then make the same result.
class Claim {
 public:
  static constexpr double lasts_s = 600.0, renewed_after_s = 60.0;

  /// Takes the claim. Nullopt if another living process holds it. Throws DataError if the file cannot be written.
  static std::optional<Claim> take(const std::filesystem::path& path);
  /// Same as `take`, but waits until the claim is free.
  static Claim wait_for(const std::filesystem::path& path);
  /// Removes the claim of a child process that is gone. Does not remove the claims of other processes.
  static void end_of(pid_t process, const std::filesystem::path& path);

  /// Removes the file, unless another process has taken it over.
  ~Claim();
  Claim(Claim&&) noexcept;
  Claim& operator=(Claim&&) noexcept;

 private:
  struct Held;
  explicit Claim(std::unique_ptr<Held> held);
  std::unique_ptr<Held> held_;
};

}  // namespace modebank::app
