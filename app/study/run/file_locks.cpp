#include "app/study/run/file_locks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <system_error>

#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
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

}  // namespace

FileLocks::FileLocks(const std::filesystem::path& path) : path_(path) {
  refuse_special_file(path);
  remove_link(path);
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0)
    throw DataError(fmt::format("cannot open {}: {}", path.string(), std::generic_category().message(errno)));
}

FileLocks::~FileLocks() { ::close(descriptor_); }

FileLocks::Hold::~Hold() {
  if (!locks_) return;
  struct flock lock = record(F_UNLCK, place_);
  ::fcntl(locks_->descriptor_, F_SETLK, &lock);
}

FileLocks::Hold FileLocks::without_lock(long long place) const {
  const std::string reason = std::generic_category().message(errno);
  static std::once_flag said;
  std::call_once(said, [&] {
    spdlog::warn(
        "{}: no locks on this file system ({}): processes that work on the study at a time may make a run twice, and "
        "the results are the same; --study.shard i/n gives each process runs of its own",
        path_.string(), reason);
  });
  return {this, place};
}

FileLocks::Hold FileLocks::try_lock(const std::string& name) const {
  const long long place = lock_place(name);
  struct flock lock = record(F_WRLCK, place);
  if (::fcntl(descriptor_, F_SETLK, &lock) == 0) return {this, place};
  if (errno == EACCES || errno == EAGAIN) return {};
  return without_lock(place);
}

FileLocks::Hold FileLocks::lock(const std::string& name) const {
  const long long place = lock_place(name);
  struct flock lock = record(F_WRLCK, place);
  while (::fcntl(descriptor_, F_SETLKW, &lock) != 0)
    if (errno != EINTR) return without_lock(place);
  return {this, place};
}

bool FileLocks::is_held_elsewhere(const std::string& name) const {
  struct flock lock = record(F_WRLCK, lock_place(name));
  return ::fcntl(descriptor_, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace modebank::app
