#include "io/files/replace_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "io/files/read_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

namespace fs = std::filesystem;

std::string system_reason() { return std::generic_category().message(errno); }

/// Thrown if the disk fails in a folder that could otherwise contain the file.
struct DiskFailure : DataError {
  using DataError::DataError;
};

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// An open file descriptor. A call of close() reports errors; the destructor ignores them.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (descriptor_ >= 0) return;
    if (is_disk_failure({errno, std::generic_category()})) throw DiskFailure(system_reason());
    throw DataError(system_reason());
  }
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) throw DataError(system_reason());
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void sync() const {
    // Some file systems cannot sync a folder and return EINVAL, which is ignored.
    if (::fsync(descriptor_) != 0 && errno != EINVAL) throw DataError(system_reason());
  }
  void close() {
    if (::close(std::exchange(descriptor_, -1)) != 0) throw DataError(system_reason());
  }

 private:
  int descriptor_;
};

/// A file with a temporary name. The destructor removes the file unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target)
      : path_(temporary_path(target)), descriptor_(path_, O_WRONLY | O_CREAT | O_EXCL) {}
  ~TemporaryFile() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const fs::path& path() const { return path_; }
  void write(std::string_view bytes) const { descriptor_.write(bytes); }
  void become(const fs::path& target) {
    descriptor_.sync();
    descriptor_.close();
    fs::rename(path_, target);
    path_.clear();
  }

 private:
  fs::path path_;
  Descriptor descriptor_;
};

}  // namespace

fs::path final_target(const fs::path& path) {
  constexpr int most_links = 40;  // Linux's limit
  fs::path target = path;
  std::error_code error;
  for (int link = 0; link <= most_links; ++link) {
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    // If the link's target is absolute, it replaces the folder.
    target = folder_of(target) / fs::read_symlink(target, error);
    if (error) throw DataError("'" + path.string() + "': " + error.message());
  }
  throw DataError("'" + path.string() + "' is a symbolic link that leads back to itself");
}

bool is_disk_failure(const std::error_code& error) {
  for (const std::errc code : {std::errc::no_space_on_device, std::errc::io_error, std::errc::file_too_large})
    if (error == code) return true;
  return error == std::error_code(EDQUOT, std::generic_category());
}

namespace {

/// Reason why a path cannot be written. Empty if no reason is known before the file is created. A symbolic link is not
/// a reason, because the file replaces the link.
std::string seen_obstacle(const fs::path& path) {
  std::error_code error;
  if (!path.has_filename()) return "'" + path.string() + "' is not the name of a file";
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder, error)) return "the folder '" + folder.string() + "' does not exist";
  const fs::file_status status = fs::symlink_status(path, error);
  if (fs::is_symlink(status)) return {};
  if (fs::is_directory(status)) return "'" + path.string() + "' is a folder";
  if (fs::exists(status) && !fs::is_regular_file(status)) return "'" + path.string() + "' is not a regular file";
  return {};
}

/// Leftovers are removed once per folder and process, because a study writes thousands of files into one folder.
void tidy_once(const fs::path& folder) {
  static std::mutex guard;
  static std::set<fs::path> tidied;
  std::error_code error;
  const fs::path place = fs::canonical(folder, error);
  if (error) return;
  {
    const std::lock_guard lock(guard);
    if (!tidied.insert(place).second) return;
  }
  remove_leftovers(place);
}

/// Creates the file with a temporary name. Throws an error with the reason on failure. Only this test is reliable,
/// because permissions do not show read-only mounts, /proc or the rights of root.
TemporaryFile make_temporary(const fs::path& path) {
  tidy_once(folder_of(path));
  try {
    return TemporaryFile(path);
  } catch (const DiskFailure&) {
    throw;
  } catch (const DataError& obstacle) {
    throw DataError("the folder '" + folder_of(path).string() + "' is not writable: " + obstacle.what());
  }
}

}  // namespace

std::string write_obstacle(const fs::path& path) {
  try {
    if (std::string obstacle = seen_obstacle(path); !obstacle.empty()) return obstacle;
    make_temporary(path);  // the file was created as a test and is removed at once
  } catch (const DiskFailure& failure) {
    throw DataError("cannot write " + path.string() + ": " + failure.what());
  } catch (const DataError& obstacle) {
    return obstacle.what();
  }
  return {};
}

namespace {

/// `named`: the path that error messages contain.
void replace(const fs::path& path, const fs::path& named, const std::function<void(const fs::path&)>& fill) {
  try {
    if (const std::string obstacle = seen_obstacle(path); !obstacle.empty()) throw DataError(obstacle);
    TemporaryFile temporary = make_temporary(path);
    fill(temporary.path());
    temporary.become(path);
    Descriptor(folder_of(path), O_RDONLY | O_DIRECTORY).sync();
  } catch (const DataError& error) {
    throw DataError("cannot write " + named.string() + ": " + error.what());
  } catch (const fs::filesystem_error& error) {
    throw DataError("cannot write " + named.string() + ": " + error.code().message());
  }
}

void append(const fs::path& path, std::string_view bytes) { Descriptor(path, O_WRONLY | O_APPEND).write(bytes); }

}  // namespace

void replace_file(const fs::path& path, const std::function<void(const fs::path&)>& fill) { replace(path, path, fill); }

void replace_file(const fs::path& path, std::initializer_list<std::string_view> pieces) {
  replace(path, path, [&](const fs::path& temporary) {
    for (const std::string_view piece : pieces) append(temporary, piece);
  });
}

void write_staged(const fs::path& staged, const fs::path& place, std::string_view content) {
  replace(staged, place, [&](const fs::path& temporary) { append(temporary, content); });
}

void remove_link(const fs::path& path) {
  std::error_code error;
  if (fs::is_symlink(fs::symlink_status(path, error))) fs::remove(path, error);
}

void append_to_file(const fs::path& path, std::string_view text) {
  remove_link(path);
  std::error_code error;
  if (fs::hard_link_count(path, error) > 1 && !error) replace_file(path, {read_file(path)});
  Descriptor(path, O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW).write(text);
}

void make_own_folder(const fs::path& path) {
  remove_link(path);
  fs::create_directories(path);
}

}  // namespace modebank
