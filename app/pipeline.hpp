#pragma once

#include <string>
#include <vector>

#include "app/config.hpp"
#include "io/archive.hpp"

namespace modebank::app {

/// The stages of a run. Each fills its part of the archive from the parts before it, and logs one line of progress.
void import_stage(const Config& config, Archive& archive);
void identify_stage(const Config& config, Archive& archive);
/// Whether identify alone writes its windows as they are fitted, because there are too many to hold in memory.
bool streams_windows(const Config& config, const Archive& archive);
/// Does so; returns the summary.
std::string identify_into_file(const Config& config, const Archive& archive);
void cluster_stage(const Config& config, Archive& archive);
void bank_stage(const Config& config, Archive& archive);
void evaluate_stage(const Config& config, Archive& archive);

/// Residual tests of the global model and of every evaluated filter, on all runs.
void residual_test_stage(const Config& config, Archive& archive);

/// The global model of the windows in linear terms, whatever they were fitted with.
GlobalModel linear_global(const Config& config, const Archive& archive);

/// The two halves of bank_stage: baseline and noise_only depend on the windows alone; the bank takes the baseline's R.
void competitors_stage(const Config& config, Archive& archive);
void modes_stage(const Config& config, Archive& archive);

/// What evaluate_stage finds for one filter.
struct FilterScores {
  FilterEvaluation evaluation;
  std::vector<SummaryRow> summary;
  std::vector<HorizonRow> horizons;
  std::vector<DiagnosticsRow> diagnostics;
};
/// `name`: bank, baseline or noise_only.
FilterScores score_filter(const Config& config, const Archive& archive, const std::string& name);
/// Replaces an archive's evaluations and their rows, in the order given.
void take_scores(std::vector<FilterScores> scores, Archive& archive);
ResidualTestSet test_global(const Config& config, const Archive& archive);
ResidualTestSet test_filter(const Archive& archive, const FilterEvaluation& evaluation);

/// Replaces the banks by those stored in config.archive.bank. Throws DataError when its channels do not fit the data's.
void load_banks(const Config& config, Archive& archive);

/// Checks values against each other, before any file of data is opened. Throws ConfigurationError naming the keys.
void validate(const Config& config);

}  // namespace modebank::app
