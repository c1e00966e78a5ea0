#include "filter/judge/evaluate.hpp"

#include <cmath>

#include "filter/step/bank_filter.hpp"
#include "filter/step/imm.hpp"
#include "filter/step/samples.hpp"
#include "ident/data/public_recording.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/judge/evaluate.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// `bank`: any bank with the sizes of the filter's results.
template <class Filter>
RunEvaluation evaluate_samples(const Bank& bank, Filter&& filter, const Trajectory& run) {
  const Index n = bank.structure.states, N = run.samples();
  RunEvaluation e;
  FilterEstimate sample = filter.estimate();  // of the states of the sample itself
  sample.prediction.conservativeResize(n);
  sample.state.conservativeResize(n);
  sample.covariance.conservativeResize(n, n);
  each_part(sample, e, [N](const auto& value, Eigen::MatrixXd& values) { values.resize(value.size(), N); });
  e.pit_width.resize(bank.is_quantised() ? bank.C.rows() : 0, bank.is_quantised() ? N : 0);
  e.nis.resize(N);
  e.log_density.resize(N);
  for (Index k = 0; k < N; ++k) {
    take_measured(filter.step(sample_time_s(run, k), run.input.col(k), run.state.col(k)), sample);
    each_part(sample, e, [k](const auto& value, Eigen::MatrixXd& values) { values.col(k) = value.reshaped(); });
    if (bank.is_quantised()) e.pit_width.col(k) = sample.pit_width;
    e.nis(k) = sample.nis;
    e.log_density(k) = sample.log_density;
  }
  return e;
}

/// The mode of every instant. `score`: log probability of the best sequence that ends in each mode.
template <int N, int NY>
Eigen::VectorXi best_sequence(const Bank& bank, const Trajectory& run, const RunInstants& instants,
                              const FilterOptions& options) {
  ImmFilter<N, NY> filter(bank, options);
  const Index K = bank.mode_count();
  if (K == 1) return Eigen::VectorXi::Zero(instants.count());
  Eigen::MatrixXi from = Eigen::MatrixXi::Zero(K, instants.count());
  Eigen::VectorXi best(instants.count());
  Eigen::MatrixXd log_T = bank.transition.matrix().array().log();
  Eigen::VectorXd score(K), next(K);
  for (Index t = 0; t < instants.count(); ++t) {
    const bool starts = instants.instants[t].starts;
    if (!starts && !bank.transition_logit.empty()) log_T = filter.transition(instants.inputs.col(t)).array().log();
    const bool measured = !std::isnan(follow(instants, t, run, filter));
    for (Index j = 0; j < K && !starts; ++j) {
      Index before = j;
      next(j) = (score + log_T.col(j)).maxCoeff(&before);
      from(j, t) = static_cast<int>(before);
      if (measured) next(j) += filter.log_likelihood()(j);
    }
    if (starts) next = bank.initial_probability.array().max(mode_probability_floor).log();
    score = next.array() - next.maxCoeff();
    score.maxCoeff(&best(t));
  }
  Eigen::VectorXi mode(instants.count());
  for (Index t = instants.count() - 1; t >= 0; --t)
    mode(t) = instants.continues(t) ? from(mode(t + 1), t + 1) : best(t);
  return mode;
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

Eigen::VectorXi mode_sequence(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  const RunInstants instants(bank, run);
  FilterOptions judged = options;
  // The mixing of salvi2025, as printed, does not keep even a known state.
  if (judged.variant == FilterVariant::salvi2025) judged.variant = FilterVariant::imm;
  const Eigen::VectorXi modes = with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() {
    return best_sequence<N, NY>(bank, run, instants, judged);
  });
  Eigen::VectorXi sequence = Eigen::VectorXi::Constant(run.samples(), -1);
  for (Index t = 0; t < instants.count(); ++t)
    if (const Index sample = instants.instants[t].sample; sample >= 0) sequence(sample) = modes(t);
  return sequence;
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
