#include "filter/smoother.hpp"

#include <limits>

#include "filter/filter_step.hpp"
#include "filter/run_instants.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// The filter's estimates at every moment of a run, one moment per column.
template <int N, int NY>
class FilteredHistory {
 public:
  FilteredHistory(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory)
      : n_(model.structure.dimension()), K_(model.mode_count()) {
    means_.resize(n_ * K_, run.count());
    covariances_.resize(n_ * n_ * K_, run.count());
    probability_.resize(K_, run.count());
    noise_scale_.resize(run.count());
    fill(model, run, trajectory);
  }

  void get(Index t, std::size_t mode, Gaussian<N>& estimate) const {
    const auto j = static_cast<Index>(mode);
    estimate.mean = means_.col(t).segment(j * n_, n_);
    estimate.covariance = covariances_.col(t).segment(j * n_ * n_, n_ * n_).reshaped(n_, n_);
  }
  auto probability(Index t) const { return probability_.col(t); }
  double noise_scale(Index t) const { return noise_scale_(t); }

 private:
  Index n_, K_;
  Eigen::MatrixXd means_, covariances_, probability_;
  Eigen::VectorXd noise_scale_;

  void fill(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory) {
    FilterStep<N, NY> step(model);
    FilterState<N> state = initial_state(model);
    for (Index t = 0; t < run.count(); ++t) {
      step_to(model, run, t, trajectory, state, step);
      for (Index j = 0; j < K_; ++j) {
        const Gaussian<N>& mode = state.modes[static_cast<std::size_t>(j)];
        means_.col(t).segment(j * n_, n_) = mode.mean;
        covariances_.col(t).segment(j * n_ * n_, n_ * n_) = mode.covariance.reshaped();
      }
      probability_.col(t) = state.mode_probability;
      noise_scale_(t) = state.noise_scale;
    }
  }
};

/// Kim's backward pass: from the smoothed estimates of moment t + 1 to those of moment t.
template <int N, int NY>
class BackwardPass {
 public:
  BackwardPass(const FilterModel<N, NY>& model, const FilteredHistory<N, NY>& history)
      : model_(model),
        history_(history),
        kalman_(n(), model.C.rows(), model.structure.regressors()),
        cholesky_(n()),
        gain_(n(), n()),
        product_(n(), n()),
        closed_loop_(n(), n()),
        filtered_(n()),
        pairs_(model.modes.size(), Gaussian<N>(n())),
        modes(model.modes.size(), Gaussian<N>(n())),
        probability(model.mode_count()),
        next_(modes),
        weights_(model.mode_count(), model.mode_count()) {}

  /// The end of a stretch: there is nothing to add to the filter.
  void begin(Index t) {
    for (std::size_t j = 0; j < modes.size(); ++j) history_.get(t, j, modes[j]);
    probability = history_.probability(t);
  }

  /// `input`: acting on the step from t to t + 1.
  template <class U>
  void step(Index t, const U& input) {
    next_ = modes;
    weigh_pairs(t);
    for (std::size_t j = 0; j < modes.size(); ++j) {
      history_.get(t, j, filtered_);
      const auto row = static_cast<Index>(j);
      for (std::size_t k = 0; k < modes.size(); ++k)
        if (weights_(row, static_cast<Index>(k)) > 0.0) smooth_pair(filtered_, input, k, history_.noise_scale(t));
      if (probability(row) > 0.0)
        merge(pairs_, weights_.row(row) / probability(row), modes[j]);
      else
        modes[j] = filtered_;
    }
  }

 private:
  const FilterModel<N, NY>& model_;
  const FilteredHistory<N, NY>& history_;
  KalmanStep<N, NY> kalman_;
  small::Cholesky<N> cholesky_;
  Eigen::Matrix<double, N, N> gain_, product_, closed_loop_;
  Gaussian<N> filtered_;
  std::vector<Gaussian<N>> pairs_;

 public:
  std::vector<Gaussian<N>> modes;  ///< smoothed, given each mode
  Eigen::VectorXd probability;     ///< smoothed

 private:
  std::vector<Gaussian<N>> next_;
  Eigen::MatrixXd weights_;  ///< P(mode j at t, mode k at t + 1 | all)

  Index n() const { return model_.structure.dimension(); }

  void weigh_pairs(Index t) {
    const auto mu = history_.probability(t);
    if (model_.variant == FilterVariant::mmae || model_.mode_count() == 1) {
      weights_ = probability.asDiagonal();
    } else {
      weights_ = mu.asDiagonal() * model_.transition.matrix();
      for (Index k = 0; k < weights_.cols(); ++k) {
        const double c = weights_.col(k).sum();
        weights_.col(k) *= c < impossible_probability ? 0.0 : probability(k) / c;
      }
      weights_ /= weights_.sum();
    }
    probability = weights_.rowwise().sum();
  }

  /// Rauch, Tung & Striebel's step for mode k next; the covariance as a sum of squares, which rounding keeps definite.
  template <class U>
  void smooth_pair(const Gaussian<N>& filtered, const U& input, std::size_t k, double noise_scale) {
    const auto& mode = model_.modes[k];
    Gaussian<N>& result = pairs_[k];
    kalman_.predict(filtered, model_, mode, input, noise_scale);
    cholesky_.factorise(kalman_.predicted.covariance);
    small::multiply_transposed(gain_, filtered.covariance, mode.F);
    for (Index i = 0; i < n(); ++i) cholesky_.solve(gain_.row(i));
    const Eigen::Matrix<double, N, 1> change = next_[k].mean - kalman_.predicted.mean;
    small::multiply(result.mean, gain_, change);
    result.mean += filtered.mean;
    small::multiply(closed_loop_, gain_, mode.F);
    closed_loop_ = -closed_loop_;
    closed_loop_.diagonal().array() += 1.0;
    small::multiply(product_, closed_loop_, filtered.covariance);
    result.covariance.setZero();
    small::add_symmetric_product(result.covariance, product_, closed_loop_);
    closed_loop_ = kalman_.process_noise + next_[k].covariance;
    small::multiply(product_, gain_, closed_loop_);
    small::add_symmetric_product(result.covariance, product_, gain_);
    if (!is_finite(result)) result = filtered;
  }
};

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

/// The best history of every mode, moment by moment.
template <int N, int NY>
class BestHistories {
 public:
  BestHistories(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory)
      : K_(model.mode_count()), log_transition_(model.transition.matrix().array().log()) {
    from_.setZero(K_, run.count());
    best_.setZero(run.count());
    FilterStep<N, NY> step(model);
    FilterState<N> state = initial_state(model);
    Eigen::VectorXd score(K_);
    for (Index t = 0; t < run.count(); ++t) {
      const bool starts = run.instants[static_cast<std::size_t>(t)].starts;
      state.mode_probability.setConstant(1.0 / static_cast<double>(K_));  // histories are scored here, not there
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
  Eigen::MatrixXd log_transition_;
  Eigen::MatrixXi from_;  ///< K x moments: the mode before, on the best history that ends in mode j
  Eigen::Matrix<Index, Eigen::Dynamic, 1> best_;

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
                              const FilterOptions& options) {
  const FilterModel<N, NY> model(bank, options);
  if (model.mode_count() == 1) return Eigen::VectorXi::Zero(instants.count());
  return BestHistories<N, NY>(model, instants, run).trace(instants);
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
    return best_sequence<N, NY>(steady, run, instants, pairs);
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
  evaluation.viterbi_mode = viterbi(bank, run, options);
  if (options.variant == FilterVariant::salvi2025) return;
  FilterOptions forward = options;
  if (options.variant == FilterVariant::gpb1) forward.variant = FilterVariant::gpb2;
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { smooth<N, NY>(bank, run, forward, evaluation); });
}

}  // namespace modebank
