#include "filter/judge/smoother.hpp"

#include <limits>

#include "filter/judge/backward_pass.hpp"
#include "filter/judge/drifting_mode_sequence.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

template <int N, int NY>
void smooth(const Bank& bank, const Trajectory& run, const FilterOptions& options, RunEvaluation& evaluation) {
  const FilterModel<N, NY> model(bank, options);
  const RunInstants instants(bank, run, options.time_steps);
  const FilteredHistory<N, NY> history(model, instants, run);
  const Index n = model.structure.dimension();
  evaluation.smoothed_state.setConstant(n, run.samples(), not_a_number);
  evaluation.smoothed_covariance.setConstant(n * n, run.samples(), not_a_number);
  BackwardPass<N, NY> pass(model, history);
  Gaussian<N> moments(n);
  for (Index t = instants.count() - 1; t >= 0; --t) {
    if (instants.continues(t))
      pass.step(t, instants.inputs.col(t + 1));
    else
      pass.begin(t);
    const Index sample = instants.instants[static_cast<std::size_t>(t)].sample;
    if (sample < 0) continue;
    merge(pass.modes, pass.probability, moments);
    evaluation.smoothed_state.col(sample) = moments.mean;
    evaluation.smoothed_covariance.col(sample) = moments.covariance.reshaped();
  }
}

/// What the noise of every moment's step was multiplied by in the filter itself; ones unless it adapts.
template <int N, int NY>
Eigen::VectorXd noise_scales(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory) {
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(run.count());
  if (!model.adaptive) return scales;
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  for (Index t = 0; t < run.count(); ++t) {
    scales(t) = state.noise_scale;
    step_to(model, run, t, trajectory, state, step);
  }
  return scales;
}

/// The best history of every mode, moment by moment. `scales`: as noise_scales says. A scale of its own would follow
/// this pass, whose modes count as equally probable at every moment, and take a change of mode for one of scale.
template <int N, int NY>
class BestHistories {
 public:
  BestHistories(const FilterModel<N, NY>& model, const Eigen::VectorXd& scales, const RunInstants& run,
                const Trajectory& trajectory)
      : K_(model.mode_count()),
        model_(model),
        transition_(K_, model.transition_logit),
        log_transition_(model.transition.matrix().array().log()) {
    from_.setZero(K_, run.count());
    best_.setZero(run.count());
    FilterStep<N, NY> step(model);
    FilterState<N> state = initial_state(model);
    Eigen::VectorXd score(K_);
    for (Index t = 0; t < run.count(); ++t) {
      const bool starts = run.instants[static_cast<std::size_t>(t)].starts;
      state.mode_probability.setConstant(1.0 / static_cast<double>(K_));  // histories are scored here, not there
      state.noise_scale = scales(t);
      if (!starts) set_transition(state, run.inputs.col(t));
      const bool measured = step_to(model, run, t, trajectory, state, step);
      if (starts)
        score = model.initial_probability.array().max(mode_probability_floor).log();
      else
        extend(t, measured, step, state, score);
      score.maxCoeff(&best_(t));
    }
  }

  /// The mode of every moment on the best history that ends each stretch.
  Eigen::VectorXi trace(const RunInstants& run) const {
    Eigen::VectorXi mode(run.count());
    for (Index t = run.count() - 1; t >= 0; --t)
      mode(t) = run.continues(t) ? from_(mode(t + 1), t + 1) : static_cast<int>(best_(t));
    return mode;
  }

 private:
  Index K_;
  const FilterModel<N, NY>& model_;
  TransitionWorkspace transition_;
  Eigen::MatrixXd log_transition_;
  Eigen::MatrixXi from_;  ///< K x moments: the mode before, on the best history that ends in mode j
  Eigen::Matrix<Index, Eigen::Dynamic, 1> best_;

  /// Each row at the state that its mode's best history has reached.
  template <class U>
  void set_transition(const FilterState<N>& state, const U& input) {
    if (model_.transition_logit.empty()) return;
    for (Index i = 0; i < K_; ++i)
      log_transition_.row(i) = transition_at(model_.transition.matrix(), model_.transition_logit,
                                             state.modes[static_cast<std::size_t>(i)].mean, input, transition_)
                                   .row(i)
                                   .array()
                                   .log();
  }

  void extend(Index t, bool measured, const FilterStep<N, NY>& step, FilterState<N>& state, Eigen::VectorXd& score) {
    Eigen::VectorXd next(K_);
    for (Index j = 0; j < K_; ++j) {
      double best = -std::numeric_limits<double>::infinity();
      Index from = j;
      for (Index i = 0; i < K_; ++i) {
        const double value = score(i) + log_transition_(i, j) + (measured ? step.log_likelihood(j * K_ + i) : 0.0);
        if (value > best) {
          best = value;
          from = i;
        }
      }
      next(j) = best;
      from_(j, t) = static_cast<int>(from);
      state.modes[static_cast<std::size_t>(j)] = step.corrected[static_cast<std::size_t>(j * K_ + from)];
    }
    score = next.array() - next.maxCoeff();
  }
};

template <int N, int NY>
Eigen::VectorXi best_sequence(const Bank& bank, const Trajectory& run, const RunInstants& instants,
                              const FilterOptions& options, const FilterOptions& pairs) {
  const FilterModel<N, NY> model(bank, pairs);
  if (model.mode_count() == 1) return Eigen::VectorXi::Zero(instants.count());
  const Eigen::VectorXd scales = noise_scales(FilterModel<N, NY>(bank, options), instants, run);
  return BestHistories<N, NY>(model, scales, instants, run).trace(instants);
}

/// The pairs of modes that GPB2 steps through, whatever the variant.
Eigen::VectorXi viterbi(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  const RunInstants instants(bank, run, options.time_steps);
  FilterOptions pairs = options;
  if (options.variant != FilterVariant::kf) pairs.variant = FilterVariant::gpb2;
  Bank steady = bank;
  if (options.variant == FilterVariant::mmae)
    steady.transition = TransitionMatrix(Eigen::MatrixXd::Identity(bank.mode_count(), bank.mode_count()));
  const Eigen::VectorXi modes = with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() {
    return best_sequence<N, NY>(steady, run, instants, options, pairs);
  });
  Eigen::VectorXi sequence = Eigen::VectorXi::Constant(run.samples(), -1);
  for (Index t = 0; t < instants.count(); ++t)
    if (const Index sample = instants.instants[static_cast<std::size_t>(t)].sample; sample >= 0)
      sequence(sample) = modes(t);
  return sequence;
}

}  // namespace

void smooth_run(const Bank& bank, const Trajectory& run, const FilterOptions& options, RunEvaluation& evaluation) {
  check_run(bank, run);
  if (!bank.drift.empty()) {
    evaluation.viterbi_mode = drifting_mode_sequence(bank, run, options);
    return;
  }
  evaluation.viterbi_mode = viterbi(bank, run, options);
  if (options.variant == FilterVariant::salvi2025) return;
  FilterOptions forward = options;
  if (options.variant == FilterVariant::gpb1) forward.variant = FilterVariant::gpb2;
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { smooth<N, NY>(bank, run, forward, evaluation); });
}

}  // namespace modebank
