#include "io/recording/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw ConfigurationError("cannot read " + path.string() + ": " +
                           std::error_code(error, std::generic_category()).message());
}

constexpr std::size_t window_bytes = 1 << 16;  // small, so that only a sixteenth of a file with images is read

}  // namespace

FileBytes::FileBytes(std::filesystem::path path) : path_(std::move(path)) { open(); }

FileBytes::~FileBytes() { close(); }

void FileBytes::open() {
  if (file_ >= 0) return;
  file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) fail(path_, errno);
  struct stat status {};
  int error = fstat(file_, &status) == 0 ? 0 : errno;
  if (error == 0 && S_ISDIR(status.st_mode)) error = EISDIR;
  if (error != 0) {
    close();
    fail(path_, error);
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

void FileBytes::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  window_bytes_ = 0;
  window_ = {};
}

std::size_t FileBytes::read(std::uint64_t at, std::size_t bytes, char* to) const {
  std::error_code error;
  const std::size_t done = read_at(file_, to, bytes, at, error);
  if (error) throw Damage(at + done, error.message());
  return done;
}

std::string_view FileBytes::viewed(std::uint64_t at, std::size_t bytes) {
  if (at < window_at_ || at + bytes > window_at_ + window_bytes_) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(std::max(bytes, window_bytes), size_ - at));
    window_bytes_ = 0;
    if (window_.size() < wanted) window_.resize(wanted);
    window_at_ = at;
    window_bytes_ = read(at, wanted, window_.data());
    if (window_bytes_ < bytes) throw Damage(at, "it became shorter while it was read");
  }
  return {window_.data() + (at - window_at_), bytes};
}

}  // namespace modebank
