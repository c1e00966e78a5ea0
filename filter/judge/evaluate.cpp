#include "filter/judge/evaluate.hpp"

#include <cmath>
#include <memory>

#include "filter/step/bank_filter.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/stepper.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

RunEvaluation sized_evaluation(const Bank& bank, Index samples) {
  const Index n = bank.structure.dimension(), n_y = bank.C.rows(), K = bank.mode_count();
  RunEvaluation e;
  e.prediction.resize(n, samples);
  e.innovation.resize(n_y, samples);
  e.innovation_covariance.resize(n_y * n_y, samples);
  e.state.resize(n, samples);
  e.covariance.resize(n * n, samples);
  e.nis.resize(samples);
  e.pit.resize(n_y, samples);
  e.log_density.resize(samples);
  e.mode_probability_predicted.resize(K, samples);
  e.mode_probability.resize(K, samples);
  e.spread_share.resize(samples);
  return e;
}

void record(const FilterEstimate& estimate, Index k, RunEvaluation& e) {
  e.prediction.col(k) = estimate.prediction;
  e.innovation.col(k) = estimate.innovation;
  e.innovation_covariance.col(k) = estimate.innovation_covariance.reshaped();
  e.state.col(k) = estimate.state;
  e.covariance.col(k) = estimate.covariance.reshaped();
  e.nis(k) = estimate.nis;
  e.pit.col(k) = estimate.pit;
  e.log_density(k) = estimate.log_density;
  e.mode_probability_predicted.col(k) = estimate.mode_probability_predicted;
  e.mode_probability.col(k) = estimate.mode_probability;
  e.spread_share(k) = estimate.spread_share;
}

/// Filter alone: calls take(k, log density) for every sample it scores.
template <class Take>
void score_samples(const Bank& bank, const Trajectory& run, const FilterOptions& options, Take take) {
  const std::unique_ptr<Stepper> stepper = make_stepper(bank, options);
  RunSamples(bank, run, options.time_steps).for_each([&](const SampleFeed& feed, Index k, bool starts) {
    if (starts) return stepper->start(feed.start());
    stepper->advance(feed.inputs(), feed.steps());
    const double log_density = stepper->update(run.state.col(k));
    if (!std::isnan(log_density)) take(k, log_density);
  });
}

}  // namespace

RunEvaluation evaluate_run(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  BankFilter filter(bank, options);
  RunEvaluation evaluation = sized_evaluation(bank, run.samples());
  for (Index k = 0; k < run.samples(); ++k)
    record(filter.step(sample_time_s(run, k), run.input.col(k), run.state.col(k)), k, evaluation);
  return evaluation;
}

double log_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  double sum = 0.0;
  score_samples(bank, run, options, [&](Index, double log_density) { sum += log_density; });
  return sum;
}

Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(run.samples(), not_a_number);
  score_samples(bank, run, options, [&](Index k, double log_density) { result(k) = log_density; });
  return result;
}

}  // namespace modebank
