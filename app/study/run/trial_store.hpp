#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace modebank::app {

/// A study's folder: plan.h5, trials/, cache/, log.csv, study.h5, study.csv. A trial is done when a complete archive
/// has its final name. A failed trial has a text file with the reason in the same folder. A running trial has a claim
/// (claim.hpp).
class TrialStore {
 public:
  explicit TrialStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Makes missing folders. Throws ConfigurationError.
  void create() const;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path archive(const std::string& key) const;
  std::filesystem::path claim(const std::string& key) const;
  /// Claim of a process that writes plan.h5, study.h5 or study.csv.
  std::filesystem::path plan_claim() const { return folder_ / "plan.claim"; }
  std::filesystem::path cache() const { return folder_ / "cache"; }
  std::filesystem::path log() const { return folder_ / "log.csv"; }

  /// Whether the name exists; a link to nothing counts. problems() checks whether it is an archive.
  bool has_archive(const std::string& key) const;
  /// Faults of a trial's archive by its hash; empty if it is complete.
  std::vector<std::string> problems(const std::string& key) const;

  /// Reason why the trial failed; nullopt if it did not.
  std::optional<std::string> failure(const std::string& key) const;
  void record_failure(const std::string& key, const std::string& message) const;
  void forget_failure(const std::string& key) const;

  /// Trials that have archives, records of failure or claims. The folder is listed, because only that makes a network
  /// file system show new files of other machines at once.
  struct Listing {
    std::set<std::string> archives, failures, claims;  ///< keys of trials
  };
  Listing list() const;
  /// Lists the study's folders, so that a network file system shows new files.
  void look_again() const;

  /// Removes unfinished files of killed processes of this machine.
  void remove_leftovers() const;

 private:
  std::filesystem::path failure_file(const std::string& key) const;

  std::filesystem::path folder_;
};

}  // namespace modebank::app
