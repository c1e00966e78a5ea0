#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <optional>

namespace modebank::app {

/// A small file that names the process at work: host, number and start time of the process, and time. The file is there
/// while the work goes on; a thread renews its time every minute. A claim is over when its process is gone on this
/// host, or when it was not renewed for ten minutes by the folder's own clock, which is the time of a file written
/// there: clocks of machines that share a folder differ. So is one whose time lies ten minutes ahead of that clock,
/// which was set back since. The next process takes it over by rename.
///
/// Claims save work and nothing else. Two processes may both hold one after a long pause or on a file system without
/// hard links; both then make the same result.
class Claim {
 public:
  static constexpr double lasts_s = 600.0, renewed_after_s = 60.0;

  /// Nothing while another living process holds it. Throws DataError when the file cannot be written.
  static std::optional<Claim> take(const std::filesystem::path& path);
  /// The same, and waits for it.
  static Claim wait_for(const std::filesystem::path& path);
  /// Removes the claim of a child process that is gone, if it is that process's.
  static void end_of(pid_t process, const std::filesystem::path& path);

  /// Removes the file, if it is still this claim's.
  ~Claim();
  Claim(Claim&&) noexcept;
  Claim& operator=(Claim&&) noexcept;

 private:
  struct Held;
  explicit Claim(std::unique_ptr<Held> held);
  std::unique_ptr<Held> held_;
};

}  // namespace modebank::app
