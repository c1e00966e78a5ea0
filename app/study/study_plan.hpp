#pragma once

#include <filesystem>
#include <string>

#include "app/command_line.hpp"
#include "app/config.hpp"
#include "app/study/study_table.hpp"

namespace modebank::app {

/// What a study will run: its points in order, each with the key of its archive.
struct StudyPlan {
  std::string config;     ///< the study's resolved configuration, its [study] section included
  std::string data_hash;  ///< of the configuration's own data
  std::string version;    ///< modebank's
  StudyTable table;       ///< planned or dropped rows, no scores
};

/// Lays out the points of config.study, drops invalid ones with the reason and computes the keys; reads the data's
/// bytes. Throws ConfigurationError.
StudyPlan make_plan(const Config& config);

/// The configuration of one trial, as `modebank run` would take it: the study's with the varied values and the seed,
/// without a [study] section of its own. archive.output is its archive in the study's folder.
Config trial_config(const Config& study, const StudyPlan& plan, const TrialRow& row);

/// trials/<key>.h5 in a study's folder.
std::filesystem::path trial_archive(const std::filesystem::path& folder, const std::string& key);

/// plan.h5 of a study's folder.
std::filesystem::path plan_file(const std::filesystem::path& folder);
void write_plan(const std::filesystem::path& folder, const StudyPlan& plan, const CommandLine& line);
StudyPlan read_plan(const std::filesystem::path& folder);

}  // namespace modebank::app
