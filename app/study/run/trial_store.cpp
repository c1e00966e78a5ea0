#include "app/study/run/trial_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "app/study/space/study_plan.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/files/look_twice.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* failure_extension = ".failed";
/// Between a message and the execution that it is of.
constexpr std::string_view execution_mark = "\nrecorded by ";

std::optional<FailureRecord> read_failure(const fs::path& path) try {
  refuse_special_file(path);
  std::ifstream file(path);
  if (!file) return std::nullopt;
  FailureRecord record{{std::istreambuf_iterator<char>(file), {}}, {}};
  while (!record.message.empty() && record.message.back() == '\n') record.message.pop_back();
  const auto mark = record.message.rfind(execution_mark);
  if (mark == std::string::npos) return record;
  record.execution = record.message.substr(mark + execution_mark.size());
  record.message.resize(mark);
  return record;
} catch (const DataError& error) {
  return FailureRecord{error.what(), {}};
}

}  // namespace

void TrialStore::create() const {
  std::error_code error;
  fs::create_directories(folder_ / "trials", error);
  if (!error) fs::create_directories(cache(), error);
  const std::string what = fmt::format("study.output: cannot make {}: {}", folder_.string(), error.message());
  if (is_disk_failure(error)) throw DataError(what);
  if (error) throw ConfigurationError(what);
  refuse_special_file(log());
  if (const std::string obstacle = write_obstacle(folder_ / "study.h5"); !obstacle.empty())
    throw ConfigurationError("study.output: " + obstacle);
}

fs::path TrialStore::archive(const std::string& key) const { return trial_archive(folder_, key); }

fs::path TrialStore::failure_file(const std::string& key) const {
  return folder_ / "trials" / (key + failure_extension);
}

bool TrialStore::has_archive(const std::string& key) const {
  std::error_code unreadable;
  return fs::exists(fs::symlink_status(archive(key), unreadable));
}

std::vector<std::string> TrialStore::problems(const std::string& key) const try {
  refuse_special_file(archive(key));
  // Where another process put it anew meanwhile, the old content may be gone (ESTALE): the second look counts.
  look_twice([&] { return OpenArchive(archive(key)); });
  return {};
} catch (const std::exception& error) {
  return {error.what()};
}

std::optional<FailureRecord> TrialStore::failure(const std::string& key) const {
  return read_failure(failure_file(key));
}

std::map<std::string, FailureRecord> TrialStore::failures() const {
  std::map<std::string, FailureRecord> all;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "trials", error))
    if (entry.path().extension() == failure_extension)
      if (auto record = read_failure(entry.path())) all[entry.path().stem().string()] = std::move(*record);
  return all;
}

void TrialStore::record_failure(const std::string& key, const FailureRecord& failure) const {
  replace_file(failure_file(key), {failure.message, execution_mark, failure.execution, "\n"});
}

void TrialStore::look_again() const {
  for (const fs::path& part : {folder_, folder_ / "trials"}) {
    std::error_code absent;
    for ([[maybe_unused]] const fs::directory_entry& entry : fs::directory_iterator(part, absent)) continue;
  }
}

void TrialStore::forget_failure(const std::string& key) const {
  std::error_code ignored;
  fs::remove(failure_file(key), ignored);
}

void TrialStore::remove_leftovers() const {
  for (const fs::path& part : {folder_, folder_ / "trials", cache()}) modebank::remove_leftovers(part);
}

}  // namespace modebank::app
