#include "filter/judge/run/smoother.hpp"

#include <limits>

#include "filter/judge/run/backward_pass.hpp"
#include "filter/judge/run/drifting_mode_sequence.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Pairs of modes with a lower probability do not change a digit of the smoothed values.
constexpr double negligible_pair = 1e-18;
constexpr double rounding = 1e-6;  // nats, far above the rounding of a log density

template <int N, int NY>
void smooth(const Bank& bank, const Trajectory& run, const FilterOptions& options, RunEvaluation& evaluation) {
  const FilterModel<N, NY> model(bank, options);
  const RunInstants instants(bank, run);
  const FilteredHistory<N, NY> history(model, instants, run);
  const Index n = model.structure.dimension(), states = model.structure.states;
  evaluation.smoothed_state.setConstant(states, run.samples(), not_a_number);
  evaluation.smoothed_covariance.setConstant(states * states, run.samples(), not_a_number);
  BackwardPass<N, NY> pass(model, history, negligible_pair);
  Gaussian<N> moments(n);
  for (Index t = instants.count() - 1; t >= 0; --t) {
    if (instants.continues(t))
      pass.step(t, instants.inputs.col(t + 1));
    else
      pass.begin(t);
    const Index sample = instants.instants[static_cast<std::size_t>(t)].sample;
    if (sample < 0) continue;
    merge(pass.modes, pass.probability, moments);
    evaluation.smoothed_state.col(sample) = moments.mean.head(states);
    evaluation.smoothed_covariance.col(sample) = moments.covariance.topLeftCorner(states, states).reshaped();
  }
}

/// The noise factors of the filter at every moment. They are one unless noise adapts or depends on state and input.
template <int N, int NY>
Eigen::VectorXd noise_scales(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory) {
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(run.count());
  if (!model.adaptive && model.noise_factor.empty()) return scales;
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  for (Index t = 0; t < run.count(); ++t) {
    scales(t) =
        run.instants[static_cast<std::size_t>(t)].starts ? 1.0 : noise_of_step(model, state, run.inputs.col(t), step);
    step_to(model, run, t, trajectory, state, step);
  }
  return scales;
}

/// The best history of every mode, moment by moment. `scales`: from noise_scales. This pass cannot adapt the scale
/// itself. Its modes count as equally probable at every moment, so it would mistake a change of mode for a change of
/// scale.
template <int N, int NY>
class BestHistories {
 public:
  BestHistories(const FilterModel<N, NY>& model, const Eigen::VectorXd& scales, const RunInstants& run,
                const Trajectory& trajectory)
      : K_(model.mode_count()),
        model_(model),
        transition_(K_, model.transition_logit),
        log_transition_(model.transition.matrix().array().log()),
        kalman_(model.structure.dimension(), model.C.rows(), model.structure.regressors()),
        partial_(model.structure.dimension(), model.C.rows()),
        least_(model.C.rows()),
        score_(K_),
        modes_(initial_state(model).modes),
        next_modes_(modes_) {
    from_.setZero(K_, run.count());
    best_.setZero(run.count());
    FilterState<N> state = initial_state(model);
    for (Index t = 0; t < run.count(); ++t) {
      const Instant& instant = run.instants[static_cast<std::size_t>(t)];
      if (instant.starts) {
        start(model, instant.start, state);
        modes_ = state.modes;
        score_ = model.initial_probability.array().max(mode_probability_floor).log();
      } else {
        set_transition(run.inputs.col(t));
        extend(t, run, instant, trajectory, scales(t));
      }
      score_.maxCoeff(&best_(t));
    }
  }

  /// The mode of every moment on the best history of each stretch.
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
  Eigen::MatrixXi from_;  ///< K x moments: the previous mode on the best history that ends in mode j
  Eigen::Matrix<Index, Eigen::Dynamic, 1> best_;
  KalmanStep<N, NY> kalman_;
  PartialSensor<N, NY> partial_;
  small::Ldl<NY> least_;
  Eigen::VectorXd score_;                        ///< score of every mode's best history
  std::vector<Gaussian<N>> modes_, next_modes_;  ///< states at the end of the best histories

  /// Row j holds for the state of mode j's best history.
  template <class U>
  void set_transition(const U& input) {
    if (model_.transition_logit.empty()) return;
    for (Index i = 0; i < K_; ++i)
      log_transition_.row(i) = transition_at(model_.transition.matrix(), model_.transition_logit,
                                             modes_[static_cast<std::size_t>(i)].mean, input, transition_)
                                   .row(i)
                                   .array()
                                   .log();
  }

  void extend(Index t, const RunInstants& run, const Instant& instant, const Trajectory& trajectory, double scale) {
    const auto u = run.inputs.col(t);
    const Index n_y = model_.C.rows();
    const Index missing = instant.sample < 0 ? n_y : missing_entries(trajectory.state.col(instant.sample));
    if (missing == n_y) {
      choose(
          t, u, scale, [](const auto&) { return 0.0; },
          [this](Gaussian<N>& to) {
            to = kalman_.predicted;
            return 0.0;
          });
    } else if (missing == 0) {
      measure(t, u, scale, model_, trajectory.state.col(instant.sample), 0.0);
    } else {
      partial_.assign(model_, trajectory.state.col(instant.sample));
      measure(t, u, scale, partial_, partial_.y, 0.5 * log_two_pi * static_cast<double>(missing));
    }
  }

  /// `excess`: correction to the log density of a partial sensor.
  template <class U, class Sensor, class Y>
  void measure(Index t, const U& u, double scale, const Sensor& sensor, const Y& y, double excess) {
    const auto most = [&](const auto& mode) {
      const Eigen::Matrix<double, NY, NY> S = sensor.C * (scale * mode.Q) * sensor.C.transpose() + sensor.R;
      least_.factorise(S);
      return rounding - 0.5 * (static_cast<double>(y.size()) * log_two_pi + least_.log_determinant()) + excess;
    };
    choose(t, u, scale, most, [&](Gaussian<N>& to) {
      kalman_.expect(sensor);
      kalman_.observe(sensor, y);
      kalman_.correct(sensor, to);
      return kalman_.log_density + excess;
    });
  }

  /// Finds the best history into every mode. `most(mode)`: upper bound of the log density of a step into the mode. (S
  /// is at least the S of the mode's own noise.) The bound excludes histories that cannot be the best.
  /// `take_in(estimate)`: updates with the measurement after the prediction and returns the log density of the
  /// measurement.
  template <class U, class Most, class TakeIn>
  void choose(Index t, const U& u, double scale, Most most, TakeIn take_in) {
    Eigen::VectorXd next(K_);
    Gaussian<N> estimate = modes_.front();
    for (Index j = 0; j < K_; ++j) {
      const auto& mode = model_.modes[static_cast<std::size_t>(j)];
      const Eigen::VectorXd reach = score_ + log_transition_.col(j);
      const double least_reach = -most(mode);
      double best = -std::numeric_limits<double>::infinity();
      Index from = j, likely = 0;
      const auto step = [&](Index i) {
        kalman_.predict(modes_[static_cast<std::size_t>(i)], model_, mode, u, scale);
        const double value = reach(i) + take_in(estimate);
        if (!(value > best || (value == best && i < from))) return;
        best = value;
        from = i;
        next_modes_[static_cast<std::size_t>(j)] = estimate;
      };
      reach.maxCoeff(&likely);
      step(likely);
      for (Index i = 0; i < K_; ++i)
        if (i != likely && reach(i) - least_reach >= best) step(i);
      if (!(best > -std::numeric_limits<double>::infinity())) {  // no predecessor is possible, so the mode stays
        kalman_.predict(modes_[static_cast<std::size_t>(j)], model_, mode, u, scale);
        take_in(next_modes_[static_cast<std::size_t>(j)]);
      }
      next(j) = best;
      from_(j, t) = static_cast<int>(from);
    }
    modes_.swap(next_modes_);
    score_ = next.array() - next.maxCoeff();
  }
};

template <int N, int NY>
Eigen::VectorXi best_histories_sequence(const Bank& bank, const Trajectory& run, const RunInstants& instants,
                                        const FilterOptions& options) {
  const FilterModel<N, NY> model(bank, options);
  if (model.mode_count() == 1) return Eigen::VectorXi::Zero(instants.count());
  const Eigen::VectorXd scales = noise_scales(model, instants, run);
  return BestHistories<N, NY>(model, scales, instants, run).trace(instants);
}

/// Allows every transition between modes, in all variants.
Eigen::VectorXi viterbi(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  const RunInstants instants(bank, run);
  const Eigen::VectorXi modes = with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() {
    return best_histories_sequence<N, NY>(bank, run, instants, options);
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
  if (!bank.running_noise.empty()) return;  // a bank with running noise has one mode and exactly known states
  if (!bank.drift.empty()) {
    evaluation.viterbi_mode = drifting_mode_sequence(bank, run, options);
    return;
  }
  evaluation.viterbi_mode = viterbi(bank, run, options);
  if (options.variant == FilterVariant::salvi2025) return;
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { smooth<N, NY>(bank, run, options, evaluation); });
}

}  // namespace modebank
