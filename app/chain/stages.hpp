#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/chain/stage_inputs.hpp"
#include "io/archive/archive.hpp"

/// The stages of the chain: functions of the data, of earlier stages' results and of their inputs struct. They throw
/// ConfigurationError for inputs that do not fit the data, DataError for data that cannot be used.
namespace modebank {

/// The lags and the delay of one linear model of the training runs (ident/lag/structure_search.hpp).
FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Listener& listener);
/// The options with that structure, which stays one that is searched for.
ChainOptions with_structure(ChainOptions options, const FoundStructure& found);

/// Whether there are too many windows to hold in memory, so that they are best written as they are fitted.
bool streams_windows(const Recording& recording, const WindowInputs& inputs);

/// Fits windows and writes them to an archive of `before` (data) and windows alone. `hears` gets the windows part by
/// part. Returns what they have in common.
WindowFits identify_into_file(const std::filesystem::path& path, const Archive& before, const WindowInputs& inputs,
                              const std::function<void(const WindowFits&)>& hears);

WindowFits identify(const Recording& recording, const WindowInputs& inputs);

MixtureResult cluster(const Recording& recording, const WindowFits& windows, const MixtureInputs& inputs,
                      const Listener& listener);

/// The global model of the windows in linear terms, whatever they were fitted with.
GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const FitOptions& window);

/// One linear model of the training runs.
struct OneModel {
  std::string model;  ///< the windows', if it has their lags
  LinearStructure structure;
  GlobalModel global;
};
/// With these lags; empty: the windows'.
OneModel one_model(const Recording& recording, const WindowFits& windows, const FitOptions& window,
                   const std::optional<Lags>& lags);

/// The baseline: one Kalman filter on the global model. `filter`: that runs competitors.
Bank learn_single_filter(const Recording& recording, const OneModel& of, const FilterOptions& filter,
                         const Listener& listener);

struct Competitors {
  Bank baseline;                       ///< one Kalman filter
  Bank noise_only;                     ///< switches noise alone
  DriftingModel drifting;              ///< one linear model whose coefficients wander
  std::optional<Bank> nonlinear = {};  ///< one motion that bends; empty where no term gains on the training runs
};
Competitors learn_competitors(const Recording& recording, const WindowFits& windows, const CompetitorInputs& inputs,
                              const Listener& listener);

/// What a bank is learned from.
struct LearnedFrom {
  const Recording& recording;
  const WindowFits& windows;
  const MixtureResult& mixture;
  const Bank& baseline;
};
struct LearnedBank {
  Bank bank;
  std::optional<Bank> unrefined;  ///< that refinement started from
  MeasuredFit measured_fit = MeasuredFit::none;
  std::vector<MergingCost> merging;  ///< where a limit on the number of modes merged some
  Index learned_transitions = 0;     ///< that refinement learned from; 0: all of the training runs'
  std::vector<Bank> of_splits = {};  ///< as Refinement has them
};
LearnedBank learn_modes(const LearnedFrom& from, const BankInputs& inputs, const Listener& listener);

/// The competitor that is learned as the bank, with one theta, and from the bank's noises, too.
Refinement learn_one_motion(const LearnedFrom& from, const Bank& bank, const BankInputs& inputs,
                            const Listener& listener);

/// Scores of bank, competitors and all combined on the training runs, each run by filters that were learned without
/// it; empty where nothing was left out. `of_splits`: of bank and one_motion, the others are learned anew.
std::vector<LeftOutRow> score_left_out(const Archive& learned, const BankInputs& inputs,
                                       const std::vector<std::pair<std::string, std::vector<Bank>>>& of_splits,
                                       const Listener& listener);

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

/// The same of the drifting competitor.
FilterScores score_drifting(const DriftingModel& model, const Recording& recording, const ScoringOptions& scoring,
                            const EvaluationStream* stream = nullptr);

/// Scores all filters of the archive together, after score_ahead; none where there is one. Adds rows on their weights
/// in free runs.
std::optional<FilterScores> score_combined(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive,
                                           const EvaluationStream* stream = nullptr);

/// Adds what all filters of the archive, and their combination, predict as far ahead as is asked for.
void score_ahead(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive);

/// Free runs of every run, none where none is asked for. Throws ConfigurationError, naming the key, when the model
/// needs more measured samples than the options have.
std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options);
std::vector<FreeRun> free_runs(const DriftingModel& model, const std::vector<Trajectory>& runs,
                               const FreeRunOptions& options);
/// What is to be said of them, one line each: of the bank's, runs of which nothing was predicted; of all, paths lost.
std::vector<std::string> remarks(const std::string& filter, const std::vector<Trajectory>& runs,
                                 const std::vector<FreeRun>& free_runs);
/// Throws ConfigurationError, naming the key, unless a free run of this model can start from so many samples.
void check_free_run(const LinearStructure& structure, const FreeRunOptions& options);

/// Whether the judged runs of an archive ask for the modes of its bank, from what was scored, with its sentences; empty
/// without a scored bank.
std::optional<Finding> find_modes(const Archive& archive);

/// Of the bank's most probable modes against the labels, on the judged runs; none without labels.
std::vector<ConfusionRow> confusion_of(const Archive& archive);

/// Residual tests on all runs, of the global model's one-step residuals.
ResidualTestSet test_global(const Recording& recording, const WindowFits& windows, const FitOptions& window);

}  // namespace modebank
