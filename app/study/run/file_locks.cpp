#include "app/study/run/file_locks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// 60 bits of the name's hash: two of a million names meet with a chance below one in a million, and then only wait.
long long lock_place(const std::string& name) {
  constexpr int digits = 15;
  return std::stoll(sha256_hex(name).substr(0, digits), nullptr, 16);
}

struct flock record(short type, long long place) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = place;
  lock.l_len = 1;
  return lock;
}

[[noreturn]] void fail_lock() {
  throw DataError("cannot lock the study's folder: " + std::generic_category().message(errno));
}

}  // namespace

FileLocks::FileLocks(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0)
    throw DataError(fmt::format("cannot open {}: {}", path.string(), std::generic_category().message(errno)));
}

FileLocks::~FileLocks() { ::close(descriptor_); }

FileLocks::Hold::~Hold() {
  if (!locks_) return;
  struct flock lock = record(F_UNLCK, place_);
  ::fcntl(locks_->descriptor_, F_SETLK, &lock);
}

FileLocks::Hold FileLocks::try_lock(const std::string& name) const {
  const long long place = lock_place(name);
  struct flock lock = record(F_WRLCK, place);
  if (::fcntl(descriptor_, F_SETLK, &lock) == 0) return {this, place};
  if (errno != EACCES && errno != EAGAIN) fail_lock();
  return {};
}

FileLocks::Hold FileLocks::lock(const std::string& name) const {
  const long long place = lock_place(name);
  struct flock lock = record(F_WRLCK, place);
  while (::fcntl(descriptor_, F_SETLKW, &lock) != 0)
    if (errno != EINTR) fail_lock();
  return {this, place};
}

bool FileLocks::is_held_elsewhere(const std::string& name) const {
  struct flock lock = record(F_WRLCK, lock_place(name));
  if (::fcntl(descriptor_, F_GETLK, &lock) != 0) fail_lock();
  return lock.l_type != F_UNLCK;
}

}  // namespace modebank::app
