#include "filter/judge/run/evaluate.hpp"

#include <cmath>

#include "filter/step/feed/run_samples.hpp"
#include "filter/step/pit_draw.hpp"
#include "ident/data/public_recording.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/judge/evaluate.hpp"

namespace modebank {

namespace {

using Eigen::Index;

RunEvaluation sized_evaluation(const Bank& bank, Index samples) {
  const Index n = bank.structure.states, n_y = bank.C.rows(), K = bank.mode_count();
  RunEvaluation e;
  e.prediction.resize(n, samples);
  e.innovation.resize(n_y, samples);
  e.innovation_covariance.resize(n_y * n_y, samples);
  e.state.resize(n, samples);
  e.covariance.resize(n * n, samples);
  e.nis.resize(samples);
  e.pit.resize(n_y, samples);
  if (bank.is_quantised()) e.pit_width.setZero(n_y, samples);
  e.log_density.resize(samples);
  e.mode_probability_predicted.resize(K, samples);
  e.mode_probability.resize(K, samples);
  return e;
}

void record(const FilterEstimate& estimate, Index k, RunEvaluation& e) {
  const Index n = e.state.rows();
  e.prediction.col(k) = estimate.prediction.head(n);
  e.innovation.col(k) = estimate.innovation;
  e.innovation_covariance.col(k) = estimate.innovation_covariance.reshaped();
  e.state.col(k) = estimate.state.head(n);
  e.covariance.col(k) = estimate.covariance.topLeftCorner(n, n).reshaped();
  e.nis(k) = estimate.nis;
  e.pit.col(k) = estimate.pit;
  if (e.pit_width.size() > 0) e.pit_width.col(k) = estimate.pit_width;
  e.log_density(k) = estimate.log_density;
  e.mode_probability_predicted.col(k) = estimate.mode_probability_predicted;
  e.mode_probability.col(k) = estimate.mode_probability;
}

/// `bank`: any bank with the sizes of the filter's results.
template <class Filter>
RunEvaluation evaluate_samples(const Bank& bank, Filter&& filter, const Trajectory& run) {
  RunEvaluation evaluation = sized_evaluation(bank, run.samples());
  for (Index k = 0; k < run.samples(); ++k)
    record(filter.step(sample_time_s(run, k), run.input.col(k), run.state.col(k)), k, evaluation);
  return evaluation;
}

}  // namespace

RunEvaluation evaluate_run(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  return evaluate_samples(bank, BankFilter(bank, options), run);
}

RunEvaluation evaluate_run(const Bank& frame, const Trajectory& run, CombinedFilter& filter) {
  check_run(frame, run);
  return evaluate_samples(frame, filter, run);
}

void draw_pit(const Trajectory& run, std::uint64_t seed, RunEvaluation& evaluation) {
  if (evaluation.pit_width.size() == 0) return;
  const std::uint64_t of_run = pit_seed(seed, run.run);
  for (Index k = 0; k < evaluation.pit.cols(); ++k)
    draw_pit(of_run, k, evaluation.pit_width.col(k), evaluation.pit.col(k));
}

double log_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  double sum = 0.0;
  for (const double value : log_densities(bank, run, options)) sum += std::isnan(value) ? 0.0 : value;
  return sum;
}

}  // namespace modebank

// The public API of scoring: converts between plain vectors and Eigen.
namespace modebank::judge {

Evaluation evaluate_run(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options,
                        std::uint64_t seed) {
  const Trajectory trajectory = to_trajectory(run, bank.measurements(), bank.inputs());
  RunEvaluation e = modebank::evaluate_run(bank.internal(), trajectory, options);
  draw_pit(trajectory, seed, e);
  return {to_matrix(e.prediction), to_matrix(e.innovation),  to_matrix(e.innovation_covariance),
          to_matrix(e.state),      to_matrix(e.covariance),  to_vector(e.nis),
          to_matrix(e.pit),        to_vector(e.log_density), to_matrix(e.mode_probability)};
}

double log_likelihood(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options) {
  return modebank::log_likelihood(bank.internal(), to_trajectory(run, bank.measurements(), bank.inputs()), options);
}

}  // namespace modebank::judge
