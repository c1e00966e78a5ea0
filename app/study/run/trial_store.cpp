#include "app/study/run/trial_store.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "app/study/space/study_plan.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace fs = std::filesystem;

namespace {

constexpr const char *failure_extension = ".failed", *claim_extension = ".claim";
std::optional<std::string> read_failure(const fs::path& path) try {
  refuse_special_file(path);
  std::ifstream file(path);
  if (!file) return std::nullopt;
  std::string message{std::istreambuf_iterator<char>(file), {}};
  while (!message.empty() && message.back() == '\n') message.pop_back();
  return message;
} catch (const DataError& error) {
  return error.what();
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

fs::path TrialStore::claim(const std::string& key) const { return folder_ / "trials" / (key + claim_extension); }

fs::path TrialStore::failure_file(const std::string& key) const {
  return folder_ / "trials" / (key + failure_extension);
}

bool TrialStore::has_archive(const std::string& key) const {
  std::error_code unreadable;
  return fs::exists(fs::symlink_status(archive(key), unreadable));
}

std::vector<std::string> TrialStore::problems(const std::string& key) const try {
  refuse_special_file(archive(key));
  const OpenArchive whole(archive(key));
  return {};
} catch (const std::exception& error) {
  return {error.what()};
}

std::optional<std::string> TrialStore::failure(const std::string& key) const { return read_failure(failure_file(key)); }

void TrialStore::record_failure(const std::string& key, const std::string& message) const {
  replace_file(failure_file(key), {message, "\n"});
}

TrialStore::Listing TrialStore::list() const {
  Listing found;
  std::error_code absent;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "trials", absent)) {
    const fs::path name = entry.path().filename();
    if (name.extension() == ".h5") found.archives.insert(name.stem());
    if (name.extension() == failure_extension) found.failures.insert(name.stem());
    if (name.extension() == claim_extension) found.claims.insert(name.stem());
  }
  return found;
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
