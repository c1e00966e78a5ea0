#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace modebank::app {

/// A study's folder: plan.h5, trials/, cache/, log.csv, study.h5, study.csv. A trial is done when its archive is there
/// under its final name and whole; one that failed has a text file with the reason beside where the archive would be.
/// A trial that a process is at has a claim there (claim.hpp).
class TrialStore {
 public:
  explicit TrialStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Makes the folders that are missing. Throws ConfigurationError.
  void create() const;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path archive(const std::string& key) const;
  std::filesystem::path claim(const std::string& key) const;
  /// Held by a process that writes plan.h5, study.h5 or study.csv.
  std::filesystem::path plan_claim() const { return folder_ / "plan.claim"; }
  std::filesystem::path cache() const { return folder_ / "cache"; }
  std::filesystem::path log() const { return folder_ / "log.csv"; }

  /// Whether anything has the name, a link to nothing included; problems() says whether it is an archive.
  bool has_archive(const std::string& key) const;
  /// What is wrong with a trial's archive by its whole-file hash; nothing when it is whole.
  std::vector<std::string> problems(const std::string& key) const;

  /// Why the trial failed, if it did.
  std::optional<std::string> failure(const std::string& key) const;
  void record_failure(const std::string& key, const std::string& message) const;
  void forget_failure(const std::string& key) const;

  /// Trials whose archives, records of failure or claims are there. Their folder is listed: a network file system may
  /// deny for a minute what another machine has put where there was nothing, until the folder is listed.
  struct Listing {
    std::set<std::string> archives, failures, claims;  ///< keys
  };
  Listing list() const;
  /// Lists the study's folders for that reason alone.
  void look_again() const;

  /// Removes what killed processes of this machine were writing.
  void remove_leftovers() const;

 private:
  std::filesystem::path failure_file(const std::string& key) const;

  std::filesystem::path folder_;
};

}  // namespace modebank::app
