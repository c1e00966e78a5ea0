#include <tbb/parallel_for.h>

#include "app/chain/stages.hpp"
#include "filter/judge/diagnostics.hpp"
#include "filter/judge/drifting.hpp"
#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/judge/scores.hpp"
#include "filter/judge/smoother.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/model/residual_tests.hpp"

namespace modebank {
namespace {

std::vector<RunEvaluation> evaluate_runs(const Bank& bank, const std::vector<Trajectory>& runs,
                                         const FilterOptions& options, bool smooth, std::uint64_t seed) {
  std::vector<RunEvaluation> evaluations(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    evaluations[i] = evaluate_run(bank, runs[i], options);
    draw_pit(runs[i], seed, evaluations[i]);
    if (smooth) smooth_run(bank, runs[i], options, evaluations[i]);
  });
  return evaluations;
}

std::vector<HorizonEvaluation> look_ahead(const Bank& bank, const std::vector<Trajectory>& runs,
                                          const FilterOptions& options, const std::vector<Index>& horizons) {
  std::vector<HorizonEvaluation> evaluations(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { evaluations[i] = evaluate_horizons(bank, runs[i], options, horizons); });
  return evaluations;
}

template <class Test>
ResidualTestSet test_runs(const std::string& model, std::size_t runs, Test test) {
  ResidualTestSet set{model, std::vector<ResidualTests>(runs)};
  tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t i) { set.runs[i] = test(i); });
  return set;
}

}  // namespace

namespace {

/// `bank` and `filter`: what made the evaluations.
FilterScores scores_of(FilterEvaluation said, const Bank& bank, const FilterOptions& filter,
                       const std::vector<Trajectory>& runs, const std::vector<HorizonEvaluation>& ahead,
                       const FreeRunOptions& free_run) {
  FilterScores scores;
  said.scores = score_runs(said.runs);
  scores.summary = summarize(said.filter, runs, said.runs, said.scores);
  scores.diagnostics = diagnose(said.filter, bank, filter, runs, said.runs, said.scores);
  if (!ahead.empty()) scores.horizons = summarize_horizons(said.filter, runs, ahead);
  if (!said.free_runs.empty()) scores.free_runs = summarize_free_runs(said.filter, runs, said.free_runs, free_run);
  scores.evaluation = std::move(said);
  return scores;
}

bool looks_ahead(const ScoringOptions& scoring) { return scoring.horizon != std::vector<Index>{1}; }

}  // namespace

FilterScores score_filter(const std::string& name, const Bank& bank, const Recording& recording,
                          const FilterOptions& filter, const ScoringOptions& scoring) {
  const std::vector<Trajectory>& runs = recording.runs;
  std::vector<HorizonEvaluation> ahead;
  if (looks_ahead(scoring)) ahead = look_ahead(bank, runs, filter, scoring.horizon);
  return scores_of({name,
                    evaluate_runs(bank, runs, filter, scoring.smooth, scoring.seed),
                    {},
                    free_runs(bank, runs, filter, scoring.free_run)},
                   bank, filter, runs, ahead, scoring.free_run);
}

FilterScores score_drifting(const DriftingModel& model, const Recording& recording, TimeSteps time_steps,
                            const ScoringOptions& scoring) {
  const std::vector<Trajectory>& runs = recording.runs;
  std::vector<RunEvaluation> said(runs.size());
  std::vector<HorizonEvaluation> ahead(looks_ahead(scoring) ? runs.size() : 0);
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    said[i] = evaluate_run(model, runs[i], time_steps);
    draw_pit(runs[i], scoring.seed, said[i]);
    if (!ahead.empty()) ahead[i] = evaluate_horizons(model, runs[i], time_steps, scoring.horizon);
  });
  FilterOptions filter;
  filter.noise = FilterNoise::adaptive;  // its variance is learned on the way, so its NIS is not chi-square
  return scores_of({"drifting", std::move(said), {}, free_runs(model, runs, time_steps, scoring.free_run)},
                   fixed_bank(model), filter, runs, ahead, scoring.free_run);
}

ResidualTestSet test_global(const Recording& recording, const WindowFits& windows, const FitOptions& window) {
  const Eigen::VectorXd theta = linear_global(recording, windows, window).theta;
  return test_runs("global", recording.runs.size(),
                   [&](std::size_t i) { return test_residuals(recording.runs[i], windows.structure, theta); });
}

ResidualTestSet test_filter(const Recording& recording, const FilterEvaluation& evaluation) {
  return test_runs(evaluation.filter, recording.runs.size(),
                   [&](std::size_t i) { return test_innovations(recording.runs[i], evaluation.scores.at(i)); });
}

}  // namespace modebank
