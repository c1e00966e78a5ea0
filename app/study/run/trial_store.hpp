#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/study/answers/study_table.hpp"
#include "app/study/run/file_locks.hpp"

namespace modebank::app {

/// Held by who writes plan.h5, study.h5 or study.csv. Trials are locked by their keys, cached stages by their files'
/// names.
inline constexpr const char* plan_lock = "plan";

/// Why a trial failed, and in which execution of the study.
struct FailureRecord {
  std::string message;
  std::string execution;  ///< the random word of the program that was started; empty in records of older versions

  bool operator==(const FailureRecord&) const = default;
};

/// A study's folder: plan.h5, trials/, cache/, log.csv, study.h5, study.csv. A trial is done when its archive is there
/// under its final name and whole; one that failed has a text file with the reason beside where the archive would be.
class TrialStore {
 public:
  explicit TrialStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Makes the folders that are missing. Throws ConfigurationError.
  void create() const;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path archive(const std::string& key) const;
  std::filesystem::path lock_file() const { return folder_ / "locks"; }
  std::filesystem::path cache() const { return folder_ / "cache"; }
  std::filesystem::path log() const { return folder_ / "log.csv"; }

  /// Whether anything has the name, a link to nothing included; problems() says whether it is an archive.
  bool has_archive(const std::string& key) const;
  /// What is wrong with a trial's archive by its whole-file hash; nothing when it is whole.
  std::vector<std::string> problems(const std::string& key) const;

  /// The failure on record, if any.
  std::optional<FailureRecord> failure(const std::string& key) const;
  /// All of them by key. Whether one is older than this execution is told by these, not by times: the clocks of
  /// machines that share a folder differ.
  std::map<std::string, FailureRecord> failures() const;
  void record_failure(const std::string& key, const FailureRecord& failure) const;
  void forget_failure(const std::string& key) const;

  /// A network file system may deny for a minute what another machine has put where there was nothing: listing the
  /// folders makes it look again.
  void look_again() const;

  /// Removes what killed processes of this machine were writing.
  void remove_leftovers() const;

 private:
  std::filesystem::path failure_file(const std::string& key) const;

  std::filesystem::path folder_;
};

}  // namespace modebank::app
