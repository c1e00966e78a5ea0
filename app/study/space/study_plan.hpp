#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/study/answers/study_table.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// The runs of a study: its points in order, each with the key of its archive.
struct StudyPlan {
  std::string config;               ///< the study's resolved configuration, its [study] section included
  Provenance provenance;            ///< version, files that the trials read, hash of the configuration's own data
  StudyTable table;                 ///< planned and dropped rows, without scores
  std::size_t repeated_points = 0;  ///< number of points left out because they equal an earlier one; not stored
};

/// Name of a trial: SHA-256 of the hashes of its configuration and data, and of modebank's version.
std::string trial_key(const Config& trial, const std::string& data_hash, const std::string& version);

/// Makes the points of config.study, drops invalid ones with the reason and computes the keys. Reads all bytes of the
/// data for them. Throws ConfigurationError.
StudyPlan make_plan(const Config& config, Provenance provenance);

/// The configuration of one trial for `modebank run`: the study's with the varied values and the seed, without a
/// [study] section. archive.output is its archive in the study's folder.
Config trial_config(const Config& study, const std::vector<std::string>& varied_keys, const TrialRow& row);

/// trials/<key>.h5 in a study's folder.
std::filesystem::path trial_archive(const std::filesystem::path& folder, const std::string& key);

/// plan.h5 in a study's folder.
std::filesystem::path plan_file(const std::filesystem::path& folder);
void write_plan(const std::filesystem::path& folder, const StudyPlan& plan);
/// Throws ConfigurationError when the file does not exist, DataError when it is damaged.
StudyPlan read_plan(const std::filesystem::path& folder);

/// Throws ConfigurationError, with the differences, for a configuration that is not the plan's.
void check_plan_is_of(const StudyPlan& plan, const Config& config, const std::filesystem::path& folder);

/// Throws for a plan that lacks a run of the earlier plan, with the keys (ConfigurationError) or files (DataError) that
/// have changed.
void check_plan_goes_on(const StudyPlan& before, const StudyPlan& now, const std::filesystem::path& folder);

}  // namespace modebank::app
