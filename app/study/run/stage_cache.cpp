#include "app/study/run/stage_cache.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <algorithm>
#include <tuple>
#include <vector>

namespace modebank::app {

namespace fs = std::filesystem;

StageCache::StageCache(fs::path folder, double limit_mb, const FileLocks& locks, std::function<void(bool)> tell_waiting)
    : folder_(std::move(folder)), limit_bytes_(limit_mb * 1e6), locks_(locks), tell_waiting_(std::move(tell_waiting)) {}

FileLocks::Hold StageCache::wait_for(const std::string& stem) const {
  if (FileLocks::Hold free = locks_.try_lock(stem)) return free;
  if (tell_waiting_) tell_waiting_(true);
  FileLocks::Hold alone = locks_.lock(stem);
  if (tell_waiting_) tell_waiting_(false);
  std::error_code ignored;  // what the other has made may be denied until the folder is listed: TrialStore::look_again
  for ([[maybe_unused]] const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) continue;
  return alone;
}

void StageCache::provide(Stage stage, const std::string& key, const std::function<void(Archive&&)>& take,
                         const std::function<bool()>& compute, const std::function<Archive()>& part) const {
  const fs::path file = folder_ / stage_file_name(stage, key);
  if (limit_bytes_ <= 0.0) {
    compute();
    return;
  }
  const FileLocks::Hold alone = wait_for(file.stem().string());
  if (load(file, take)) return;
  if (compute()) store(file, part());
}

bool StageCache::load(const fs::path& file, const std::function<void(Archive&&)>& take) const {
  std::error_code error;
  if (!fs::exists(file, error)) return false;
  try {
    take(read_archive(file));
    // By the file system's clock, as the others' times are.
    ::utimensat(AT_FDCWD, file.c_str(), nullptr, AT_SYMLINK_NOFOLLOW);
    return true;
  } catch (const std::exception& damage) {  // also one that another process has just removed to make room
    spdlog::warn("{}: computed again", damage.what());
    return false;
  }
}

void StageCache::store(const fs::path& file, const Archive& part) const {
  try {
    write_archive(file, part);
    make_room();
  } catch (const std::exception& error) {  // a cache that cannot be written costs time, nothing else
    spdlog::warn("{}", error.what());
  }
}

void StageCache::make_room() const {
  std::vector<std::tuple<fs::file_time_type, double, fs::path>> files;
  double total = 0.0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    if (!is_stage_file_name(entry.path().filename().string())) continue;
    std::error_code error;
    const double bytes = static_cast<double>(entry.file_size(error));
    if (error) continue;
    files.emplace_back(entry.last_write_time(error), bytes, entry.path());
    total += bytes;
  }
  std::sort(files.begin(), files.end());
  for (const auto& [time, bytes, path] : files) {
    if (total <= limit_bytes_) return;
    std::error_code error;
    if (fs::remove(path, error)) total -= bytes;
  }
}

}  // namespace modebank::app
