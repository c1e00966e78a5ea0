#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/chain/stage_key.hpp"
#include "filter/learn/chain/stages.hpp"
#include "io/archive/archive.hpp"

/// The stages around learning (filter/learn/chain/stages.hpp). Each is a function of the data, the results of earlier
/// stages and its own struct of inputs. Throws ConfigurationError for inputs that do not fit the data, and DataError
/// for unusable data.
namespace modebank {

/// Results and scores of one filter on every run.
struct FilterScores {
  FilterEvaluation evaluation;
  std::vector<SummaryRow> summary;
  std::vector<DiagnosticsRow> diagnostics;
  std::vector<FreeRunRow> free_runs = {};
  ResidualTestSet residual_tests = {};
};

/// Destination of evaluations that are written at once. Memory contains only the arrays that find_modes and
/// confusion_of need.
struct EvaluationStream {
  EvaluationSink sink;
  bool labelled = false;  ///< whether the data have labels; the bank's mode probabilities are compared with these
};
/// True if there are so many samples that the evaluations of all filters do not fit into memory.
bool streams_evaluations(const Recording& recording);

/// `name`: bank, baseline, noise_only, one_motion or nonlinear. `stream`: null keeps all evaluations in memory.
FilterScores score_filter(const std::string& name, const Bank& bank, const Recording& recording,
                          const FilterOptions& filter, const ScoringOptions& scoring,
                          const EvaluationStream* stream = nullptr);

/// Scores the combination of all filters of the archive; call it after score_ahead. Returns nothing if there is only
/// one filter.
std::optional<FilterScores> score_combined(const FilterOptions& filter, const ScoringOptions& scoring,
                                           const Archive& archive, const EvaluationStream* stream = nullptr);

/// Adds the predictions of each filter and of the combination, for all configured horizons.
void score_ahead(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive);

/// Free runs of all runs, in parallel; empty if free runs are off (options.samples = 0).
std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options);

/// Remarks on free runs, one line each. A remark names runs for which the bank makes no prediction, or sample paths
/// that left the finite range.
std::vector<std::string> remarks(const std::string& filter, const std::vector<Trajectory>& runs,
                                 const std::vector<FreeRun>& free_runs);

/// The finding: whether the scores on the judged runs give evidence for the modes of the archive's bank. Empty without
/// a scored bank.
std::optional<Finding> find_modes(const Archive& archive);

/// Compares the bank's most probable modes with the labels on the judged runs. Empty without labels.
std::vector<ConfusionRow> confusion_of(const Archive& archive);

/// Residual tests of the global model's predictions one step ahead, on all runs.
ResidualTestSet test_global(const Recording& recording, const WindowFits& windows, const FitOptions& window);

}  // namespace modebank
