#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/chain/stage_inputs.hpp"
#include "filter/learn/chain/stages.hpp"
#include "io/archive/archive.hpp"

/// The stages around learning (filter/learn/chain/stages.hpp): functions of the data, of earlier stages' results and of
/// their inputs struct. They throw
/// ConfigurationError for inputs that do not fit the data, DataError for data that cannot be used.
namespace modebank {

/// Whether there are too many windows to hold in memory, so that they are best written as they are fitted.
bool streams_windows(const Recording& recording, const WindowInputs& inputs);

/// Fits windows and writes them to an archive of `before` (data) and windows alone. `hears` gets the windows part by
/// part. Returns what they have in common.
WindowFits identify_into_file(const std::filesystem::path& path, const Archive& before, const WindowInputs& inputs,
                              const std::function<void(const WindowFits&)>& hears);

/// What a filter said about every run, and how good that was.
struct FilterScores {
  FilterEvaluation evaluation;
  std::vector<SummaryRow> summary;
  std::vector<DiagnosticsRow> diagnostics;
  std::vector<FreeRunRow> free_runs = {};
  ResidualTestSet residual_tests = {};
};

/// Where evaluations go as soon as they are made; what stays in memory is what find_modes and confusion_of read.
struct EvaluationStream {
  EvaluationSink sink;
  bool labelled = false;  ///< the data have labels, to which the bank's mode probabilities are compared
};
/// Whether there are too many samples to hold all filters' evaluations in memory.
bool streams_evaluations(const Recording& recording);

/// `name`: bank, baseline, noise_only, one_motion or nonlinear. `stream`: null keeps all in memory.
FilterScores score_filter(const std::string& name, const Bank& bank, const Recording& recording,
                          const FilterOptions& filter, const ScoringOptions& scoring,
                          const EvaluationStream* stream = nullptr);

/// Scores all filters of the archive together, after score_ahead; none where there is one. Adds rows on their weights
/// in free runs.
std::optional<FilterScores> score_combined(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive,
                                           const EvaluationStream* stream = nullptr);

/// Adds what all filters of the archive, and their combination, predict as far ahead as is asked for.
void score_ahead(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive);

/// Remarks on free runs, one line each: of the bank's, runs of which nothing was predicted; of all, paths
/// lost.
std::vector<std::string> remarks(const std::string& filter, const std::vector<Trajectory>& runs,
                                 const std::vector<FreeRun>& free_runs);

/// Whether the judged runs of an archive ask for the modes of its bank, from what was scored, with its sentences; empty
/// without a scored bank.
std::optional<Finding> find_modes(const Archive& archive);

/// Of the bank's most probable modes against the labels, on the judged runs; none without labels.
std::vector<ConfusionRow> confusion_of(const Archive& archive);

/// Residual tests on all runs, of the global model's one-step residuals.
ResidualTestSet test_global(const Recording& recording, const WindowFits& windows, const FitOptions& window);

}  // namespace modebank
