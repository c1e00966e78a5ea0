#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/study/answers/study_table.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// What a study will run: its points in order, each with the key of its archive.
struct StudyPlan {
  std::string config;               ///< the study's resolved configuration, its [study] section included
  Provenance provenance;            ///< version, the files that the trials read, hash of the configuration's own data
  StudyTable table;                 ///< planned or dropped rows, no scores
  std::size_t repeated_points = 0;  ///< left out because they say the same as an earlier one; not stored
};

/// Names a trial: SHA-256 of its configuration's hash, its data's and
/// modebank's version.
std::string trial_key(const Config& trial, const std::string& data_hash, const std::string& version);

/// Lays out the points of config.study, drops invalid ones with the reason and computes the keys, for which it reads
/// the data's bytes.
/// Throws ConfigurationError.
StudyPlan make_plan(const Config& config, Provenance provenance);

/// The configuration of one trial, as `modebank run` would take it: the study's with the varied values and the seed,
/// without a [study] section of its own. archive.output is its archive in the study's folder.
Config trial_config(const Config& study, const std::vector<std::string>& varied_keys, const TrialRow& row);

/// trials/<key>.h5 in a study's folder.
std::filesystem::path trial_archive(const std::filesystem::path& folder, const std::string& key);

/// plan.h5 in a study's folder.
std::filesystem::path plan_file(const std::filesystem::path& folder);
void write_plan(const std::filesystem::path& folder, const StudyPlan& plan);
/// Throws ConfigurationError when there is none, DataError when it is damaged.
StudyPlan read_plan(const std::filesystem::path& folder);

/// Refuses a configuration that is not the plan's, with the differences (ConfigurationError).
void check_plan_is_of(const StudyPlan& plan, const Config& config, const std::filesystem::path& folder);

/// Refuses a plan that lacks a planned run of an earlier one, with the keys (ConfigurationError) or files (DataError)
/// that changed since.
void check_plan_goes_on(const StudyPlan& before, const StudyPlan& now, const std::filesystem::path& folder);

}  // namespace modebank::app
