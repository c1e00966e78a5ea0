#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace modebank::app {

/// The folder of a study: plan.h5, trials/, cache/, log.csv, study.h5, study.csv. The folder trials/ has, for each
/// trial:
/// - a complete archive under its final name if the trial is done,
/// - a text file with the reason if the trial failed,
/// - a claim (claim.hpp) while the trial runs.
class TrialStore {
 public:
  explicit TrialStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Makes the folders that are missing. Throws ConfigurationError if this fails.
  void create() const;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path archive(const std::string& key) const;
  std::filesystem::path claim(const std::string& key) const;
  /// Claim that a process holds while it writes plan.h5, study.h5 or study.csv.
  std::filesystem::path plan_claim() const { return folder_ / "plan.claim"; }
  std::filesystem::path cache() const { return folder_ / "cache"; }
  std::filesystem::path log() const { return folder_ / "log.csv"; }

  /// Whether a file with the archive's name exists, even a link without a target. problems() checks whether it is an
  /// archive.
  bool has_archive(const std::string& key) const;
  /// Faults of a trial's archive that its hash reveals; empty if the archive is complete.
  std::vector<std::string> problems(const std::string& key) const;

  /// Reason why the trial failed; nullopt if it did not fail.
  std::optional<std::string> failure(const std::string& key) const;
  void record_failure(const std::string& key, const std::string& message) const;
  void forget_failure(const std::string& key) const;

  /// Trials that have archives, records of failure or claims. The folder is listed, because only a listing makes a
  /// network file system show new files of other machines at once.
  struct Listing {
    std::set<std::string> archives, failures, claims;  ///< keys of the trials that have such a file
  };
  Listing list() const;
  /// Lists the folders of the study, so that a network file system shows new files.
  void look_again() const;

  /// Removes unfinished files of killed processes on this machine.
  void remove_leftovers() const;

 private:
  std::filesystem::path failure_file(const std::string& key) const;

  std::filesystem::path folder_;
};

}  // namespace modebank::app
