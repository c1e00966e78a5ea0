#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/study/answers/study_table.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// The runs of a study: all points in order, each with the key of its archive.
struct StudyPlan {
  std::string config;               ///< the study's resolved configuration with its [study] section
  Provenance provenance;            ///< version, files that the trials read, hash of the data in the configuration's
                                    ///< own [data] section
  StudyTable table;                 ///< planned and dropped rows, without scores
  std::size_t repeated_points = 0;  ///< number of points that were dropped because they equal an earlier one; not
                                    ///< stored
};

/// Name of a trial: SHA-256 of the configuration's hash, the data's hash and modebank's version.
std::string trial_key(const Config& trial, const std::string& data_hash, const std::string& version);

/// Makes the points of config.study, drops invalid points with the reason, and computes the keys. This reads all bytes
/// of the data. Throws ConfigurationError.
StudyPlan make_plan(const Config& config, Provenance provenance);

/// The configuration of one trial for `modebank run`. It is the study's configuration with the varied values and the
/// seed, without a [study] section. archive.output is the trial's archive in the study's folder.
Config trial_config(const Config& study, const std::vector<std::string>& varied_keys, const TrialRow& row);

/// Path of trials/<key>.h5 in the folder of a study.
std::filesystem::path trial_archive(const std::filesystem::path& folder, const std::string& key);

/// Path of plan.h5 in the folder of a study.
std::filesystem::path plan_file(const std::filesystem::path& folder);
void write_plan(const std::filesystem::path& folder, const StudyPlan& plan);
/// Throws ConfigurationError if the file does not exist, and DataError if it is damaged.
StudyPlan read_plan(const std::filesystem::path& folder);

/// Throws ConfigurationError if the plan was made from another configuration. The message lists the differences.
void check_plan_is_of(const StudyPlan& plan, const Config& config, const std::filesystem::path& folder);

/// Throws if the new plan lacks a run of the earlier plan. The message lists the changed keys (ConfigurationError) or
/// the changed files (DataError).
void check_plan_goes_on(const StudyPlan& before, const StudyPlan& now, const std::filesystem::path& folder);

}  // namespace modebank::app
