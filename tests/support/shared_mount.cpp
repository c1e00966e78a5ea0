// shared_mount BACKING MOUNT CACHE_S SKEW_S: shows a folder at another path, in the way a machine sees it over a
// network (libfuse3), until it is unmounted. The mount has the properties of NFS that trouble programs:
// - Every lock is refused (ENOLCK).
// - Attributes of a name (size, times, absence) are cached for CACHE_S seconds. Opening the file here ends this
// earlier,
//   for an absent name listing its folder. The content of a file is fresh after opening (close-to-open).
// - Times are SKEW_S seconds later than on the server. A machine with a slow clock sees such times.
// - If another mount replaces or removes a file while it is open here, the file is gone (ESTALE).
#define FUSE_USE_VERSION 35
#include <dirent.h>
#include <fcntl.h>
#include <fuse3/fuse.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>

namespace {

using Clock = std::chrono::steady_clock;

struct Known {
  int error = 0;  ///< ENOENT for an absent name
  struct stat about {};
  Clock::time_point until;
};

struct Mount {
  std::string backing;
  std::chrono::duration<double> cache{0.0};
  std::int64_t skew_s = 0;
  std::mutex mutex;
  std::map<std::string, Known> known;  ///< attributes by path below the mount
} mount;

std::string real(const char* path) { return mount.backing + path; }
int result(std::int64_t status) { return status < 0 ? -errno : static_cast<int>(status); }

void forget(const char* path) {
  const std::lock_guard lock(mount.mutex);
  mount.known.erase(path);
}

/// Removes a folder and everything in it from the cache.
void forget_below(const std::string& folder) {
  const std::lock_guard lock(mount.mutex);
  const std::string prefix = folder == "/" ? folder : folder + "/";
  mount.known.erase(folder);
  for (auto at = mount.known.lower_bound(prefix); at != mount.known.end() && at->first.rfind(prefix, 0) == 0;)
    at = mount.known.erase(at);
}

struct stat skewed(struct stat about) {
  about.st_mtim.tv_sec += mount.skew_s;
  about.st_atim.tv_sec += mount.skew_s;
  about.st_ctim.tv_sec += mount.skew_s;
  return about;
}

int get_attributes(const char* path, struct stat* about, fuse_file_info* file) {
  if (file) {
    if (::fstat(static_cast<int>(file->fh), about) != 0) return -errno;
    *about = skewed(*about);
    return 0;
  }
  const std::lock_guard lock(mount.mutex);
  Known& known = mount.known[path];
  if (Clock::now() >= known.until) {
    known.error = ::lstat(real(path).c_str(), &known.about) == 0 ? 0 : errno;
    known.until = Clock::now() + std::chrono::duration_cast<Clock::duration>(mount.cache);
  }
  *about = skewed(known.about);
  return -known.error;
}

int open_file(const char* path, fuse_file_info* file) {
  forget(path);
  // The kernel identifies files here by their names, and would mix pages of a replaced file with those of the new file.
  // A real network file system identifies files by numbers.
  file->direct_io = (file->flags & O_ACCMODE) == O_RDONLY;
  const int descriptor =
      ::open(real(path).c_str(), file->flags & ~O_APPEND);  // the kernel passes the offset of each write
  if (descriptor < 0) return -errno;
  file->fh = static_cast<std::uint64_t>(descriptor);
  return 0;
}

int create_file(const char* path, mode_t mode, fuse_file_info* file) {
  forget(path);
  const int descriptor = ::open(real(path).c_str(), (file->flags & ~O_APPEND) | O_CREAT, mode);
  if (descriptor < 0) return -errno;
  file->fh = static_cast<std::uint64_t>(descriptor);
  return 0;
}

/// Whether the server has deleted the file: only this mount still had it open.
bool is_stale(int descriptor) {
  struct stat about {};
  return ::fstat(descriptor, &about) == 0 && about.st_nlink == 0;
}

int read_file(const char*, char* buffer, std::size_t bytes, off_t at, fuse_file_info* file) {
  if (is_stale(static_cast<int>(file->fh))) return -ESTALE;
  return result(::pread(static_cast<int>(file->fh), buffer, bytes, at));
}

int write_file(const char* path, const char* bytes, std::size_t count, off_t at, fuse_file_info* file) {
  forget(path);
  return result(::pwrite(static_cast<int>(file->fh), bytes, count, at));
}

int truncate_file(const char* path, off_t bytes, fuse_file_info* file) {
  forget(path);
  return result(file ? ::ftruncate(static_cast<int>(file->fh), bytes) : ::truncate(real(path).c_str(), bytes));
}

int sync_file(const char*, int, fuse_file_info* file) { return result(::fsync(static_cast<int>(file->fh))); }
int flush_file(const char*, fuse_file_info*) { return 0; }
int release_file(const char*, fuse_file_info* file) { return result(::close(static_cast<int>(file->fh))); }

int list_folder(const char* path, void* buffer, fuse_fill_dir_t fill, off_t, fuse_file_info*, fuse_readdir_flags) {
  forget_below(path);
  DIR* folder = ::opendir(real(path).c_str());
  if (!folder) return -errno;
  while (const dirent* entry = ::readdir(folder))
    if (fill(buffer, entry->d_name, nullptr, 0, fuse_fill_dir_flags{}) != 0) break;
  ::closedir(folder);
  return 0;
}

int make_folder(const char* path, mode_t mode) {
  forget(path);
  return result(::mkdir(real(path).c_str(), mode));
}
int remove_file(const char* path) {
  forget(path);
  return result(::unlink(real(path).c_str()));
}
int remove_folder(const char* path) {
  forget(path);
  return result(::rmdir(real(path).c_str()));
}
int rename_file(const char* from, const char* to, unsigned flags) {
  if (flags != 0) return -EINVAL;
  forget_below(from);
  forget_below(to);
  return result(::rename(real(from).c_str(), real(to).c_str()));
}
int make_hard_link(const char* from, const char* to) {
  forget(from);
  forget(to);
  return result(::link(real(from).c_str(), real(to).c_str()));
}
int make_link(const char* target, const char* path) {
  forget(path);
  return result(::symlink(target, real(path).c_str()));
}
int read_link(const char* path, char* buffer, std::size_t bytes) {
  const ssize_t count = ::readlink(real(path).c_str(), buffer, bytes - 1);
  if (count < 0) return -errno;
  buffer[count] = '\0';
  return 0;
}
int change_mode(const char* path, mode_t mode, fuse_file_info*) {
  forget(path);
  return result(::chmod(real(path).c_str(), mode));
}
int change_times(const char* path, const timespec times[2], fuse_file_info*) {
  forget(path);
  timespec at_server[2]{times[0], times[1]};
  for (timespec& time : at_server)
    if (time.tv_nsec != UTIME_NOW && time.tv_nsec != UTIME_OMIT) time.tv_sec -= mount.skew_s;
  return result(::utimensat(AT_FDCWD, real(path).c_str(), at_server, AT_SYMLINK_NOFOLLOW));
}
int space(const char* path, struct statvfs* about) { return result(::statvfs(real(path).c_str(), about)); }

int lock_range(const char*, fuse_file_info*, int, struct flock*) { return -ENOLCK; }
int lock_whole(const char*, fuse_file_info*, int) { return -ENOLCK; }

void* start(fuse_conn_info*, fuse_config* config) {
  // The kernel caches nothing; only this program's cache counts.
  config->entry_timeout = config->negative_timeout = config->attr_timeout = 0.0;
  config->use_ino = 1;
  return nullptr;
}

fuse_operations operations() {
  fuse_operations all{};
  all.init = start;
  all.getattr = get_attributes;
  all.open = open_file;
  all.create = create_file;
  all.read = read_file;
  all.write = write_file;
  all.truncate = truncate_file;
  all.fsync = sync_file;
  all.flush = flush_file;
  all.release = release_file;
  all.readdir = list_folder;
  all.mkdir = make_folder;
  all.unlink = remove_file;
  all.rmdir = remove_folder;
  all.rename = rename_file;
  all.symlink = make_link;
  all.link = make_hard_link;
  all.readlink = read_link;
  all.chmod = change_mode;
  all.utimens = change_times;
  all.statfs = space;
  all.lock = lock_range;
  all.flock = lock_whole;
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  mount.backing = argv[1];
  mount.cache = std::chrono::duration<double>(std::atof(argv[3]));
  mount.skew_s = std::atoll(argv[4]);
  const fuse_operations all = operations();
  char foreground[] = "-f", option[] = "-o", threads[] = "max_threads=64";
  char* arguments[]{argv[0], argv[2], foreground, option, threads, nullptr};
  return fuse_main(5, arguments, &all, nullptr);
}
