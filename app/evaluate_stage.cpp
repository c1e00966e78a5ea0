#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include "app/pipeline.hpp"
#include "app/stopwatch.hpp"
#include "filter/diagnostics.hpp"
#include "filter/evaluate.hpp"
#include "filter/horizon.hpp"
#include "filter/innovation_tests.hpp"
#include "filter/scores.hpp"
#include "filter/smoother.hpp"
#include "ident/residual_tests.hpp"

namespace modebank::app {
namespace {

std::vector<RunEvaluation> evaluate_runs(const Bank& bank, const std::vector<Trajectory>& runs,
                                         const FilterOptions& options, bool smooth) {
  std::vector<RunEvaluation> evaluations(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    evaluations[i] = evaluate_run(bank, runs[i], options);
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

}  // namespace

FilterScores score_filter(const Config& config, const Archive& archive, const std::string& name) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  // The competitors stay what they are, whatever filter the bank runs in.
  const bool competitor = name != "bank";
  const FilterVariant variant = name == "baseline" ? FilterVariant::kf : FilterVariant::imm;
  const FilterOptions options = competitor ? FilterOptions{variant, false, config.filter.time_steps} : config.filter;
  const Bank& bank = *(!competitor ? archive.bank : name == "baseline" ? archive.baseline : archive.noise_only);
  FilterScores scores;
  scores.evaluation = {name, evaluate_runs(bank, runs, options, config.scoring.smooth)};
  scores.summary = summarize(name, runs, scores.evaluation.runs);
  scores.diagnostics = diagnose(name, bank, options, runs, scores.evaluation.runs);
  if (config.scoring.horizon != std::vector<Index>{1})
    scores.horizons = summarize_horizons(name, runs, look_ahead(bank, runs, options, config.scoring.horizon));
  return scores;
}

void take_scores(std::vector<FilterScores> scores, Archive& archive) {
  archive.evaluations.clear();
  archive.summary.clear();
  archive.horizons.clear();
  archive.diagnostics.clear();
  const auto append = [](auto& list, auto& rows) {
    list.insert(list.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
  };
  for (FilterScores& filter : scores) {
    archive.evaluations.push_back(std::move(filter.evaluation));
    append(archive.summary, filter.summary);
    append(archive.diagnostics, filter.diagnostics);
    append(archive.horizons, filter.horizons);
  }
}

void evaluate_stage(const Config& config, Archive& archive) {
  const Stopwatch watch;
  std::vector<FilterScores> scores;
  if (archive.bank) scores.push_back(score_filter(config, archive, "bank"));
  if (archive.baseline) scores.push_back(score_filter(config, archive, "baseline"));
  if (archive.noise_only) scores.push_back(score_filter(config, archive, "noise_only"));
  take_scores(std::move(scores), archive);
  spdlog::info("evaluation: {} filters in {:.2f} s", archive.evaluations.size(), watch.seconds());
}

namespace {

template <class Test>
ResidualTestSet test_runs(const std::string& model, std::size_t runs, Test test) {
  ResidualTestSet set{model, std::vector<ResidualTests>(runs)};
  tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t i) { set.runs[i] = test(i); });
  return set;
}

}  // namespace

ResidualTestSet test_global(const Config& config, const Archive& archive) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  const Eigen::VectorXd theta = linear_global(config, archive).theta;
  return test_runs("global", runs.size(),
                   [&](std::size_t i) { return test_residuals(runs[i], archive.windows->structure, theta); });
}

ResidualTestSet test_filter(const Archive& archive, const FilterEvaluation& evaluation) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  return test_runs(evaluation.filter, runs.size(),
                   [&](std::size_t i) { return test_innovations(runs[i], evaluation.runs[i]); });
}

void residual_test_stage(const Config& config, Archive& archive) {
  archive.residual_tests.clear();
  if (archive.windows) archive.residual_tests.push_back(test_global(config, archive));
  for (const FilterEvaluation& evaluation : archive.evaluations)
    archive.residual_tests.push_back(test_filter(archive, evaluation));
}

}  // namespace modebank::app
