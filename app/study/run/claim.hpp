#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <optional>

namespace modebank::app {

/// A small file that marks work in progress. It contains host, number and start time of the process, and a time. A
/// thread renews this time every minute during the work.
/// - A claim ends when its process is gone on this host, or when it was not renewed for ten minutes. It also ends if
///   its time lies ten minutes in the future, because the clock was set back.
/// - Times are those of files written in the folder, because the clocks of machines that share a folder differ.
/// - The next process takes the claim over by rename.
///
/// Claims only avoid double work. After a long pause, or on a file system without hard links, two processes may hold
/// the same claim; both then make the same result.
class Claim {
 public:
  static constexpr double lasts_s = 600.0, renewed_after_s = 60.0;

  /// Takes the claim. Nullopt while another living process holds it. Throws DataError when the file cannot be written.
  static std::optional<Claim> take(const std::filesystem::path& path);
  /// The same, but waits until the claim is free.
  static Claim wait_for(const std::filesystem::path& path);
  /// Removes the claim of a child process that is gone. Claims of other processes stay.
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
