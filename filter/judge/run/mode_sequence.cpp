#include <cmath>

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/imm_filter.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// The mode of every moment. The forward pass keeps the log probability `score` of the best sequence that ends in each
/// mode, and the mode before.
template <int N, int NY>
Eigen::VectorXi best_sequence(const Bank& bank, const Trajectory& run, const RunInstants& instants,
                              const FilterOptions& options) {
  ImmFilter<N, NY> filter(bank, options);
  const FilterModel<N, NY>& model = filter.model();
  if (model.mode_count() == 1) return Eigen::VectorXi::Zero(instants.count());
  const Index K = model.mode_count();
  Eigen::MatrixXi from = Eigen::MatrixXi::Zero(K, instants.count());
  Eigen::VectorXi best(instants.count());
  Eigen::MatrixXd log_T = model.transition.matrix().array().log();
  Eigen::VectorXd score(K), next(K);
  for (Index t = 0; t < instants.count(); ++t) {
    const bool starts = instants.instants[static_cast<std::size_t>(t)].starts;
    if (!starts && !model.transition_logit.empty()) log_T = filter.transition(instants.inputs.col(t)).array().log();
    const bool measured = !std::isnan(follow(instants, t, run, filter));
    for (Index j = 0; j < K && !starts; ++j) {
      Index before = j;
      next(j) = (score + log_T.col(j)).maxCoeff(&before);
      from(j, t) = static_cast<int>(before);
      if (measured) next(j) += filter.log_likelihood()(j);
    }
    if (starts) next = model.initial_probability.array().max(mode_probability_floor).log();
    score = next.array() - next.maxCoeff();
    score.maxCoeff(&best(t));
  }
  Eigen::VectorXi mode(instants.count());
  for (Index t = instants.count() - 1; t >= 0; --t)
    mode(t) = instants.continues(t) ? from(mode(t + 1), t + 1) : best(t);
  return mode;
}

}  // namespace

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
    if (const Index sample = instants.instants[static_cast<std::size_t>(t)].sample; sample >= 0)
      sequence(sample) = modes(t);
  return sequence;
}

}  // namespace modebank
