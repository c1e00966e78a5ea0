#include "app/chain/stage_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "io/archive/archive.hpp"
#include "io/files/sha256.hpp"

namespace modebank {

namespace fs = std::filesystem;

namespace {

/// Whether a file name has the form that `stage_file_name` makes. Only such files are removed from a folder of stages.
bool is_stage_file_name(std::string_view name) {
  constexpr std::string_view ending = ".h5";
  const std::size_t dash = name.find('-');
  if (dash == std::string_view::npos || !name.ends_with(ending)) return false;
  name.remove_suffix(ending.size());
  return parse_name<Stage>(name.substr(0, dash)) && is_sha256(name.substr(dash + 1));
}

}  // namespace

std::string stage_file_name(Stage stage, std::string_view key) { return fmt::format("{}-{}.h5", name_of(stage), key); }

void StageStore::provide(Stage stage, const std::string& key, const StagePart& part) {
  // The data stage is not stored, because the file would be a second copy of the log.
  if (stage == Stage::data || stage > rules_.last || rules_.limit_mb <= 0.0) return part.compute();
  const fs::path file = folder_ / stage_file_name(stage, key);
  if (load(file, part)) return;
  const Stopwatch watch;
  part.compute();
  if (watch.seconds() > std::max(rules_.worth_a_file_s, part.writing_s)) store(file, part);
}

bool StageStore::load(const fs::path& file, const StagePart& part) const {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  try {
    part.take(read_archive(file));
    // Uses the file system's clock, because the other files' times also come from this clock.
    ::utimensat(AT_FDCWD, file.c_str(), nullptr, AT_SYMLINK_NOFOLLOW);
    if (rules_.kept) rules_.kept();
    spdlog::info("{}: taken from an earlier run", file.string());
    return true;
  } catch (const std::exception& damage) {  // or another process has just removed the file to make room
    spdlog::warn("{}: computed again", damage.what());
    return false;
  }
}

void StageStore::store(const fs::path& file, const StagePart& part) const {
  Archive result = part.give();
  try {
    fs::create_directory(folder_);
    write_archive(file, result);
    if (rules_.kept) rules_.kept();
    if (std::isfinite(rules_.limit_mb)) make_room();
  } catch (const std::exception& obstacle) {  // a file that was not written costs only time later
    spdlog::debug("{}", obstacle.what());
  }
  part.take(std::move(result));
}

void StageStore::make_room() const {
  constexpr double bytes_per_mb = 1e6;
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
    if (total <= rules_.limit_mb * bytes_per_mb) return;
    std::error_code error;
    if (fs::remove(path, error)) total -= bytes;
  }
}

void StageStore::clear() const {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error))
    if (is_stage_file_name(entry.path().filename().string())) fs::remove(entry.path(), error);
  fs::remove(folder_, error);  // fails on purpose if the folder contains other files
}

}  // namespace modebank
