#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/equations/filter_step.hpp"
#include "filter/step/feed/run_samples.hpp"

/// Kim's (1994) smoother on the modes' filtered estimates, moment by moment. smooth_run stores its results.
/// Expectation-maximisation with measurement noise takes its expectations from this smoother.
namespace modebank {

/// The filter's estimates at every moment of a run. Exactly known rows (from Gaussian::uncertain on) are stored once
/// for all modes, without covariances. The lags of an exact sensor then take n numbers per moment instead of K (n +
/// n^2).
template <int N, int NY>
class FilteredHistory {
 public:
  FilteredHistory(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory)
      : n_(model.structure.dimension()), K_(model.mode_count()) {
    const Eigen::Index uncertain = model.exact ? 0 : n_;  // largest number of uncertain rows over the moments
    values_.reserve(static_cast<std::size_t>(run.count() * numbers_of(uncertain)));
    first_.resize(run.count());
    probability_.resize(K_, run.count());
    noise_scale_.resize(run.count());
    uncertain_.resize(run.count());
    fill(model, run, trajectory);
  }

  void get(Eigen::Index t, std::size_t mode, Gaussian<N>& estimate) const {
    const Eigen::Index u = uncertain_(t), known = n_ - u;
    const double* const values = values_.data() + first_(t);
    const double* const own = values + known + static_cast<Eigen::Index>(mode) * (u + u * u);
    estimate.mean.head(u) = Eigen::Map<const Eigen::VectorXd>(own, u);
    estimate.mean.tail(known) = Eigen::Map<const Eigen::VectorXd>(values, known);
    if (known > 0) estimate.covariance.setZero();
    estimate.covariance.topLeftCorner(u, u) = Eigen::Map<const Eigen::MatrixXd>(own + u, u, u);
    estimate.uncertain = u;
  }
  auto probability(Eigen::Index t) const { return probability_.col(t); }
  double noise_scale(Eigen::Index t) const { return noise_scale_(t); }

 private:
  Eigen::Index n_, K_;
  std::vector<double> values_;  ///< per moment: means of the known rows, then for each mode mean and covariance of the
                                ///< uncertain rows
  Eigen::VectorX<Eigen::Index> first_;  ///< index of the first value of each moment
  Eigen::MatrixXd probability_;
  Eigen::VectorXd noise_scale_;
  Eigen::VectorX<Eigen::Index> uncertain_;

  /// Number of values of a moment.
  Eigen::Index numbers_of(Eigen::Index uncertain) const { return n_ - uncertain + K_ * uncertain * (1 + uncertain); }

  template <class Values>
  void append(const Values& values) {
    for (const double value : values.reshaped()) values_.push_back(value);
  }

  void fill(const FilterModel<N, NY>& model, const RunInstants& run, const Trajectory& trajectory) {
    FilterStep<N, NY> step(model);
    FilterState<N> state = initial_state(model);
    for (Eigen::Index t = 0; t < run.count(); ++t) {
      step_to(model, run, t, trajectory, state, step);
      const Eigen::Index u = uncertain_(t) = uncertain_rows<N>(state.modes);
      first_(t) = std::ssize(values_);
      append(state.modes.front().mean.tail(n_ - u));
      for (const Gaussian<N>& mode : state.modes) {
        append(mode.mean.head(u));
        append(mode.covariance.topLeftCorner(u, u));
      }
      probability_.col(t) = state.mode_probability;
      noise_scale_(t) = state.noise_scale;
    }
  }
};

/// Two successive moments and their modes, given the whole run.
template <int N>
struct SmoothedPair {
  std::size_t from, to;                     ///< mode at t, mode at t + 1
  double weight;                            ///< P(from, to | all)
  const Gaussian<N>&now, &next;             ///< states at t given both modes, and at t + 1 given `to`
  const Eigen::Matrix<double, N, N>& gain;  ///< Cov(now, next) = gain next.covariance
};

/// Kim's backward pass: computes the smoothed estimates of moment t from those of moment t + 1.
template <int N, int NY>
class BackwardPass {
 public:
  /// Ignores pairs of modes less probable than `negligible`.
  BackwardPass(const FilterModel<N, NY>& model, const FilteredHistory<N, NY>& history, double negligible = 0.0)
      : model_(model),
        history_(history),
        negligible_(negligible),
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
        weights_(model.mode_count(), model.mode_count()),
        transition_(model.mode_count(), model.transition_logit),
        combined_(n()) {}

  /// Begins at the end of a stretch. There the smoothed estimates equal the filtered ones.
  void begin(Eigen::Index t) {
    for (std::size_t j = 0; j < modes.size(); ++j) history_.get(t, j, modes[j]);
    probability = history_.probability(t);
  }

  /// `input`: acts on the step from t to t + 1.
  template <class U>
  void step(Eigen::Index t, const U& input) {
    step(t, input, [](const SmoothedPair<N>&) {});
  }
  /// Makes the same step. Calls visit(pair) for every pair of modes that is not negligible.
  template <class U, class Visit>
  void step(Eigen::Index t, const U& input, Visit visit) {
    next_ = modes;
    weigh_pairs(t, input);
    const double noise_scale = noise_of_step(t, input);
    for (std::size_t j = 0; j < modes.size(); ++j) {
      history_.get(t, j, filtered_);
      const auto row = static_cast<Eigen::Index>(j);
      for (std::size_t k = 0; k < modes.size(); ++k)
        if (const double weight = weights_(row, static_cast<Eigen::Index>(k)); weight > 0.0) {
          smooth_pair(filtered_, input, k, noise_scale);
          visit(SmoothedPair<N>{j, k, weight, pairs_[k], next_[k], gain_});
        }
      if (probability(row) > 0.0 && filtered_.uncertain > 0)
        merge(pairs_, weights_.row(row) / probability(row), modes[j]);
      else
        modes[j] = filtered_;
    }
  }

 private:
  const FilterModel<N, NY>& model_;
  const FilteredHistory<N, NY>& history_;
  double negligible_;
  KalmanStep<N, NY> kalman_;
  small::Ldl<N> cholesky_;
  Eigen::Matrix<double, N, N> gain_, product_, closed_loop_;
  Gaussian<N> filtered_;
  std::vector<Gaussian<N>> pairs_;

 public:
  std::vector<Gaussian<N>> modes;  ///< smoothed estimate of each mode
  Eigen::VectorXd probability;     ///< smoothed probabilities

 private:
  std::vector<Gaussian<N>> next_;
  Eigen::MatrixXd weights_;  ///< P(mode j at t, mode k at t + 1 | all)
  TransitionWorkspace transition_;
  Eigen::Matrix<double, N, 1> combined_;  ///< combined over all modes

  Eigen::Index n() const { return model_.structure.dimension(); }

  void combine(Eigen::Index t) {
    combined_.setZero();
    for (std::size_t j = 0; j < modes.size(); ++j) {
      history_.get(t, j, filtered_);
      combined_ += history_.probability(t)(static_cast<Eigen::Index>(j)) * filtered_.mean;
    }
  }

  /// Same meaning as in the filter (imm.hpp).
  template <class U>
  double noise_of_step(Eigen::Index t, const U& input) {
    if (model_.noise_factor.empty()) return history_.noise_scale(t);
    combine(t);
    return history_.noise_scale(t) * model_.noise_factor.at(combined_, input);
  }

  template <class U>
  const Eigen::MatrixXd& transition_from(Eigen::Index t, const U& input) {
    if (model_.transition_logit.empty()) return model_.transition.matrix();
    combine(t);
    return transition_at(model_.transition.matrix(), model_.transition_logit, combined_, input, transition_);
  }

  template <class U>
  void weigh_pairs(Eigen::Index t, const U& input) {
    const auto mu = history_.probability(t);
    if (model_.mode_count() == 1) {
      weights_ = probability.asDiagonal();
    } else {
      weights_ = mu.asDiagonal() * transition_from(t, input);
      for (Eigen::Index k = 0; k < weights_.cols(); ++k) {
        const double c = weights_.col(k).sum();
        weights_.col(k) *= c < impossible_probability ? 0.0 : probability(k) / c;
      }
      if (negligible_ > 0.0) weights_ = (weights_.array() < negligible_).select(0.0, weights_);
      weights_ /= weights_.sum();
    }
    probability = weights_.rowwise().sum();
  }

  /// One step of the Rauch-Tung-Striebel smoother, if mode k is next. The covariance is a sum of squares, so it remains
  /// definite under rounding.
  template <class U>
  void smooth_pair(const Gaussian<N>& filtered, const U& input, std::size_t k, double noise_scale) {
    const auto& mode = model_.modes[k];
    Gaussian<N>& result = pairs_[k];
    if (filtered.uncertain == 0) {  // states are known exactly, so later samples add no information
      result = filtered;
      gain_.setZero();
      return;
    }
    result.uncertain = n();
    kalman_.predict(filtered, model_, mode, input, noise_scale);
    cholesky_.factorise(kalman_.predicted.covariance);
    find_gain(filtered, mode.F);
    const Eigen::Matrix<double, N, 1> change = next_[k].mean - kalman_.predicted.mean;
    small::multiply(result.mean, gain_, change);
    result.mean += filtered.mean;
    closed_loop_ = kalman_.process_noise + next_[k].covariance;
    multiply_gain(product_, closed_loop_);
    result.covariance.setZero();
    add_gain_product(result.covariance);
    add_what_is_left(filtered, mode.F, result.covariance);
    if (!is_finite(result)) result = filtered;
  }

  /// Number of rows of the next state that repeat the present state (lags). The gain of these rows is a shift and
  /// leaves no uncertainty.
  Eigen::Index repeated() const { return n() - model_.full_rows; }

  /// Computes the gain P F' P_next^-1.
  void find_gain(const Gaussian<N>& filtered, const Eigen::Matrix<double, N, N>& F) {
    gain_.setZero();
    for (Eigen::Index i = 0; i < repeated(); ++i) gain_(i, i + model_.full_rows) = 1.0;
    for (Eigen::Index i = repeated(); i < n(); ++i) {
      for (Eigen::Index j = 0; j < n(); ++j) gain_(i, j) = filtered.covariance.row(i).dot(F.row(j));
      cholesky_.solve(gain_.row(i));
    }
  }

  /// out = gain a.
  void multiply_gain(Eigen::Matrix<double, N, N>& out, const Eigen::Matrix<double, N, N>& a) const {
    const Eigen::Index shift = model_.full_rows;
    out.topRows(repeated()) = a.middleRows(shift, repeated());
    for (Eigen::Index i = repeated(); i < n(); ++i)
      for (Eigen::Index j = 0; j < n(); ++j) out(i, j) = gain_.row(i).dot(a.col(j));
  }

  /// out += product gain', symmetric.
  void add_gain_product(Eigen::Matrix<double, N, N>& out) const {
    for (Eigen::Index j = 0; j < n(); ++j)
      for (Eigen::Index i = j; i < n(); ++i) {
        out(i, j) += j < repeated() ? product_(i, j + model_.full_rows) : product_.row(i).dot(gain_.row(j));
        if (i != j) out(j, i) = out(i, j);
      }
  }

  /// out += (I - gain F) P (I - gain F)'; repeated rows are zero.
  void add_what_is_left(const Gaussian<N>& filtered, const Eigen::Matrix<double, N, N>& F,
                        Eigen::Matrix<double, N, N>& out) {
    for (Eigen::Index i = repeated(); i < n(); ++i) {
      for (Eigen::Index j = 0; j < n(); ++j) closed_loop_(i, j) = (i == j ? 1.0 : 0.0) - gain_.row(i).dot(F.col(j));
      for (Eigen::Index j = 0; j < n(); ++j) product_(i, j) = closed_loop_.row(i).dot(filtered.covariance.col(j));
    }
    for (Eigen::Index j = repeated(); j < n(); ++j)
      for (Eigen::Index i = j; i < n(); ++i) {
        out(i, j) += product_.row(i).dot(closed_loop_.row(j));
        if (i != j) out(j, i) = out(i, j);
      }
  }
};

}  // namespace modebank
