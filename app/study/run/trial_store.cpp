#include "app/study/run/trial_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "app/study/space/study_plan.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace fs = std::filesystem;

void TrialStore::create() const {
  std::error_code error;
  fs::create_directories(folder_ / "trials", error);
  if (!error) fs::create_directories(cache(), error);
  if (error)
    throw ConfigurationError(fmt::format("study.output: cannot make {}: {}", folder_.string(), error.message()));
  if (const std::string obstacle = write_obstacle(folder_ / "study.h5"); !obstacle.empty())
    throw ConfigurationError("study.output: " + obstacle);
}

fs::path TrialStore::archive(const std::string& key) const { return trial_archive(folder_, key); }

fs::path TrialStore::failure_file(const std::string& key) const { return folder_ / "trials" / (key + ".failed"); }

std::vector<std::string> TrialStore::problems(const std::string& key) const { return hash_problems(archive(key)); }

bool TrialStore::has_archive(const std::string& key) const {
  std::error_code error;
  return fs::symlink_status(archive(key), error).type() != fs::file_type::not_found;
}

void TrialStore::remove_archive(const std::string& key) const {
  std::error_code error;
  fs::remove(archive(key), error);
  if (error) throw DataError(fmt::format("cannot remove {}: {}", archive(key).string(), error.message()));
}

std::optional<FailureRecord> TrialStore::failure(const std::string& key) const {
  std::error_code error;
  if (!fs::is_regular_file(failure_file(key), error)) return std::nullopt;
  std::ifstream file(failure_file(key));
  if (!file) return std::nullopt;
  FailureRecord record{{std::istreambuf_iterator<char>(file), {}}, {}};
  while (!record.message.empty() && record.message.back() == '\n') record.message.pop_back();
  std::error_code gone;
  record.time = fs::last_write_time(failure_file(key), gone);
  return record;
}

void TrialStore::record_failure(const std::string& key, const std::string& message) const {
  const std::string line = message + "\n";
  replace_file(failure_file(key), {line});
}

void TrialStore::forget_failure(const std::string& key) const {
  std::error_code ignored;
  fs::remove(failure_file(key), ignored);
}

void TrialStore::remove_leftovers() const {
  for (const fs::path& part : {folder_, folder_ / "trials", cache()}) modebank::remove_leftovers(part);
}

}  // namespace modebank::app
