#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "filter/step/gaussian.hpp"
#include "filter/step/kalman.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/covariance.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/base/not_a_number.hpp"

/// The interacting multiple model filter: Blom & Bar-Shalom 1988, "The interacting multiple model algorithm for systems
/// with Markovian switching coefficients", IEEE Transactions on Automatic Control 33(8). Equation numbers are those of
/// Bar-Shalom, Li & Kirubarajan 2001, "Estimation with Applications to Tracking and Navigation", section 11.6.6. Its
/// five steps are:
///   1  mixing probabilities    mixing_weights
///   2  mixing                  ImmFilter::mix
///   3  mode-matched filtering  KalmanStep (kalman.hpp)
///   4  mode probabilities      bayes, floor_probabilities
///   5  combination             merge
/// Comments below state what the book leaves open: modes that T forbids, likelihoods that underflow, missing signals.
namespace modebank {

/// The state of a filter.
template <int N>
struct FilterState {
  std::vector<Gaussian<N>> modes;    ///< K
  Eigen::VectorXd mode_probability;  ///< K, mu
};

/// Column j holds mu_{i|j}, the weight of each mode i in the start of mode j; columns sum to one. Rows are contiguous:
/// merge computes several columns at a time.
using MixingWeights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // K x K

/// Step 1: c_j = sum_i T_ij mu_i (11.6.6-8) and mu_{i|j} = T_ij mu_i / c_j (11.6.6-7). An impossible mode starts from
/// its own state.
inline void mixing_weights(const Eigen::MatrixXd& T, const Eigen::VectorXd& mu, Eigen::VectorXd& c, MixingWeights& W) {
  for (Eigen::Index j = 0; j < mu.size(); ++j) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < mu.size(); ++i) sum += T(i, j) * mu(i);
    c(j) = sum;
    const bool possible = sum >= impossible_probability;
    const double inverse = 1.0 / sum;
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      W(i, j) = possible ? T(i, j) * mu(i) * inverse : static_cast<double>(i == j);
  }
}

/// Mixtures j = first .. first + Count - 1 of `merge`.
template <int Count, int N, class Weights>
void merge_some(std::span<const Gaussian<N>> parts, const Weights& weights, Eigen::Index first, Gaussian<N>* merged,
                bool exact) {
  using Row = Eigen::Array<double, 1, Count>;
  const Eigen::Index n = parts[0].mean.size(), count = weights.rows();
  const Gaussian<N>* part = parts.data();
  const auto weight = [&](Eigen::Index i) { return weights.template block<1, Count>(i, first).array(); };
  for (Eigen::Index a = 0; a < n; ++a) {
    Row sum = Row::Zero();
    for (Eigen::Index i = 0; i < count; ++i) sum += weight(i) * part[i].mean(a);
    const bool same = exact && std::all_of(parts.begin(), parts.end(), [&](const Gaussian<N>& one) {
                        return one.mean(a) == parts.front().mean(a);
                      });
    for (int j = 0; j < Count; ++j) merged[j].mean(a) = same ? part[0].mean(a) : sum(j);
  }
  for (Eigen::Index b = 0; b < n; ++b)
    for (Eigen::Index a = b; a < n; ++a) {
      Row mean_a, mean_b, sum = Row::Zero();
      for (int j = 0; j < Count; ++j) {
        mean_a(j) = merged[j].mean(a);
        mean_b(j) = merged[j].mean(b);
      }
      for (Eigen::Index i = 0; i < count; ++i)
        sum += weight(i) * (part[i].covariance(a, b) + (part[i].mean(a) - mean_a) * (part[i].mean(b) - mean_b));
      for (int j = 0; j < Count; ++j) merged[j].covariance(a, b) = merged[j].covariance(b, a) = sum(j);
    }
  for (int j = 0; j < Count; ++j) merged[j].known = false;
}

/// Steps 2 and 5: mean and covariance of the mixtures sum_i weights(i, j) N(parts[i]) (moment matching), j = 0, 1, ..
/// With weights mu_{i|j} the result is the start of mode j (11.6.6-9, -10). With weights mu it is the combined estimate
/// (11.6.6-17, -18). The sum of the weights may differ from one ([S25, eq. 12-13]). `exact`: see Sensor. With it, a row
/// with the same mean in all parts keeps this mean; rounding errors would look like differences between the parts.
template <int N, class Weights>
void merge(std::type_identity_t<std::span<const Gaussian<N>>> parts, const Weights& weights,
           std::span<Gaussian<N>> merged, bool exact = false) {
  constexpr int at_once = 4;
  Eigen::Index j = 0;
  for (; j + at_once <= weights.cols(); j += at_once)
    merge_some<at_once, N>(parts, weights, j, merged.data() + j, exact);
  for (; j < weights.cols(); ++j) merge_some<1, N>(parts, weights, j, merged.data() + j, exact);
}

/// Step 4: mu_j = Lambda_j c_j / c (11.6.6-15), c = sum_j Lambda_j c_j (11.6.6-16). In the log domain, with the largest
/// term factored out, 0/0 by underflow is impossible. Returns log c. Requires at least one possible mode.
template <class Prior, class LogLikelihood>
double bayes(const Prior& prior, const LogLikelihood& log_likelihood, Eigen::VectorXd& posterior) {
  double largest = -std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < prior.size(); ++j)
    if (prior(j) >= impossible_probability) largest = std::max(largest, log_likelihood(j));
  double sum = 0.0;
  for (Eigen::Index j = 0; j < prior.size(); ++j) {
    const bool possible = prior(j) >= impossible_probability;
    posterior(j) = possible ? prior(j) * std::exp(log_likelihood(j) - largest) : 0.0;
    sum += posterior(j);
  }
  posterior *= 1.0 / sum;
  return measured_density(largest + std::log(sum));
}

inline void floor_probabilities(Eigen::VectorXd& mu) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < mu.size(); ++j) sum += mu(j) = std::max(mu(j), mode_probability_floor);
  mu *= 1.0 / sum;
}

/// The filter of a bank in fixed or dynamic size. Call `start` first, then `predict` and `update` for each sample.
/// Nothing is allocated after construction. A copy of it is a forecast: `step` predicts on without measurements. If the
/// transition matrix is constant, its moments are exact, because moments of mixtures merge exactly.
template <int N, int NY>
class ImmFilter {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  using Model = FilterModel<N, NY>;

  /// Requires check_sizes(bank). Throws std::invalid_argument for options that do not suit this bank.
  ImmFilter(const Bank& bank, const FilterOptions& options)
      : model_(std::make_shared<const Model>(bank, options)),
        state_{{bank.modes.size(), Gaussian<N>(bank.structure.dimension())}, bank.initial_probability},
        mixed_(state_.modes),
        kalman_(bank.modes.size(), {bank.structure.dimension(), bank.C.rows(), bank.structure.regressors()}),
        mixing_(MixingWeights::Zero(bank.mode_count(), bank.mode_count())),
        transition_(bank.mode_count(), bank.transition_logit),
        predicted_probability_(bank.initial_probability),
        log_likelihood_(bank.mode_count()),
        weights_(bank.mode_count()),
        partial_(model_->sensor),
        moments_(bank.structure.dimension()),
        difference_(bank.structure.dimension()),
        y_(bank.C.rows()),
        residual_(bank.C.rows()),
        spread_(bank.C.rows(), bank.C.rows()) {}

  /// Starts from the first measurement `y`; with lags, from the first complete z (StartMoments).
  void start(const Vector& y) {
    small::multiply(state_.modes[0].mean, model_->start_gain, y);
    state_.modes[0].covariance = model_->start_covariance;
    state_.modes[0].known = model_->sensor.exact;
    std::fill(state_.modes.begin() + 1, state_.modes.end(), state_.modes[0]);
    state_.mode_probability = model_->bank.initial_probability;
    floor_probabilities(state_.mode_probability);
  }
  /// Goes on from the state of a filter of the same bank.
  void start(const FilterState<N>& state) { state_ = state; }
  void start(const ImmFilter& origin) { state_ = origin.state_; }

  /// Predicts the next sample, one model step later, under the acting inputs `v`.
  void predict(const Vector& v) {
    mix(v);
    for (std::size_t j = 0; j < kalman_.size(); ++j) {
      kalman_[j].predict(mixed_[j], *model_, model_->modes[j], v);
      kalman_[j].expect(model_->sensor);
    }
  }
  /// One model step without a measurement: the prediction becomes the estimate.
  void step(const Vector& v) {
    predict(v);
    skip_measurement();
  }
  /// Steps 3 and 4 after `predict`. Returns the log predictive density [nats] of the available signals; NaN if there
  /// are none. So is log Lambda_j = log N(y - C x_j; 0, S_j) (11.6.6-13).
  double update(const Vector& y) {
    y_ = y;
    partial_.missing = missing_entries(y_);
    if (partial_.missing == y_.size()) {
      skip_measurement();
      return not_a_number;
    }
    if (partial_.missing > 0) {
      partial_.take_part(model_->sensor, y_);
      for (KalmanStep<N, NY>& mode : kalman_) mode.expect(partial_);
    }
    const double excess = 0.5 * log_two_pi * static_cast<double>(partial_.missing);
    for (Eigen::Index j = 0; j < weights_.size(); ++j) {
      kalman_[j].observe(sensor(), y_);
      kalman_[j].correct(sensor(), y_, state_.modes[j]);
      log_likelihood_(j) = kalman_[j].log_density + excess;
    }
    if (kalman_.size() == 1) return log_likelihood_(0);
    const double log_density = bayes(predicted_probability_, log_likelihood_, state_.mode_probability);
    if (model_->variant == FilterVariant::salvi2025) weigh_by_posterior();
    floor_probabilities(state_.mode_probability);
    return log_density;
  }

  const Model& model() const { return *model_; }
  const FilterState<N>& state() const { return state_; }
  const Eigen::VectorXd& mode_probability() const { return state_.mode_probability; }      ///< K
  const Eigen::VectorXd& predicted_probability() const { return predicted_probability_; }  ///< K
  const Eigen::VectorXd& log_likelihood() const { return log_likelihood_; }    ///< K, of the last measurement
  const Gaussian<N>& mixed(std::size_t j) const { return mixed_[j]; }          ///< start of mode j's last prediction
  const MixingWeights& mixing() const { return mixing_; }                      ///< of the last prediction
  const KalmanStep<N, NY>& kalman(std::size_t j) const { return kalman_[j]; }  ///< last step of mode j
  /// Sensor of the last measurement.
  const Sensor<N, NY>& sensor() const { return partial_.missing > 0 ? partial_ : model_->sensor; }
  /// T of the next step. A logit is evaluated at the combined estimate: exact if states are measured exactly.
  const Eigen::MatrixXd& transition(const Vector& v) {
    const Bank& bank = model_->bank;
    if (bank.transition_logit.empty()) return bank.transition.matrix();
    return transition_at(bank.transition.matrix(), bank.transition_logit, combined_mean(), v, transition_);
  }

  /// Moments of the predicted mixture, n and n_y x n_y: x = sum c_j x_j, S = sum c_j (S_j + (e_j - e)(e_j - e)'). Call
  /// after `predict`.
  void combine(Eigen::VectorXd& state, Eigen::MatrixXd& innovation_covariance) {
    const Eigen::VectorXd& c = predicted_probability_;
    moments_.mean.setZero();
    for (Eigen::Index j = 0; j < c.size(); ++j) moments_.mean += c(j) * kalman_[j].predicted.mean;
    spread_.setZero();
    for (Eigen::Index j = 0; j < c.size(); ++j) {
      difference_ = kalman_[j].predicted.mean - moments_.mean;
      small::multiply(residual_, model_->sensor.C, difference_);
      small::add_about_mean(spread_, c(j), kalman_[j].innovation_covariance, residual_);
    }
    state = moments_.mean;
    innovation_covariance = spread_;
  }
  /// Probability integral transform of the last measurement y (Rosenblatt 1952). Component i is the predictive
  /// distribution function at y_i, given the earlier signals y_1 .. y_(i-1), which have updated the mixture weights.
  /// NaN if y_i is missing. For a rounded signal it lies between the values at both ends of y_i's interval: `pit` is
  /// their mean and `width` their difference, else 0. `log_density`: that of `update`; if signals are rounded it
  /// becomes that of their intervals. Overwrites log_likelihood().
  void transform(const Vector& y, Eigen::VectorXd& pit, Eigen::VectorXd& width, double& log_density) {
    const bool rounded = model_->quantum.size() > 0;
    double of_intervals = 0.0;
    weights_ = predicted_probability_;
    width.setZero();
    for (Eigen::Index i = 0; i < pit.size(); ++i) {
      pit(i) = not_a_number;
      if (is_missing(y(i))) continue;
      const bool scores = rounded || i + 1 < pit.size();
      const double quantum = rounded ? model_->quantum(i) : 0.0, half = 0.5 * quantum;
      double low = 0.0, high = 0.0;
      for (Eigen::Index j = 0; j < weights_.size(); ++j) {
        const ModeSignal signal{kalman_[j].decorrelated(i), kalman_[j].cholesky.D(i)};
        const double deviation = signal.unrounded_deviation(quantum);
        high += weights_(j) * normal_cdf((signal.e + half) / deviation);
        if (quantum > 0.0) low += weights_(j) * normal_cdf((signal.e - half) / deviation);
        if (scores) log_likelihood_(j) = signal.log_density(quantum);
      }
      high = high < 1.0 ? high : 1.0;  // limits rounding errors of the sum of weights
      low = quantum > 0.0 ? std::min(low, high) : high;
      pit(i) = 0.5 * (low + high);
      width(i) = high - low;
      if (scores) of_intervals += bayes(weights_, log_likelihood_, weights_);
    }
    if (rounded) log_density = of_intervals;
  }
  /// Moments of the present mixture, n and n x n.
  void merge(Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
    modebank::merge<N>(state_.modes, state_.mode_probability, {&moments_, 1});
    mean = moments_.mean;
    covariance = moments_.covariance;
  }

  ImmFilter forecast() const { return *this; }
  /// Log density of a complete measurement [nats], with the masses of intervals for rounded signals; `error`:
  /// measurement minus combined prediction. Changes no state.
  template <class Y, class Error>
  double observe(const Y& y, Error&& error) {
    error = y;
    for (Eigen::Index j = 0; j < weights_.size(); ++j) {
      KalmanStep<N, NY>& mode = kalman_[j];
      mode.observe(model_->sensor, y);
      log_likelihood_(j) = mode.log_density;
      if (model_->quantum.size() > 0) {
        log_likelihood_(j) = 0.0;
        for (Eigen::Index i = 0; i < y.size(); ++i)
          log_likelihood_(j) += ModeSignal{mode.decorrelated(i), mode.cholesky.D(i)}.log_density(model_->quantum(i));
      }
      error -= predicted_probability_(j) * (y - mode.innovation);
    }
    return bayes(predicted_probability_, log_likelihood_, weights_);
  }
  /// Predicted distribution of signal i, whatever the other signals are.
  SignalMixture signal(Eigen::Index i) const {
    SignalMixture result{predicted_probability_, predicted_probability_, predicted_probability_};
    for (Eigen::Index j = 0; j < result.mean.size(); ++j) {
      result.mean(j) = model_->sensor.C.row(i).dot(kalman_[j].predicted.mean);
      result.deviation(j) = std::sqrt(std::max(kalman_[j].innovation_covariance(i, i), least_variance));
    }
    return result;
  }

  /// The parts of a snapshot. After they have been read, `settle` throws std::invalid_argument if the state is none.
  std::vector<SnapshotPart> parts() {
    std::vector<SnapshotPart> parts{numbers_of(state_.mode_probability)};
    for (Gaussian<N>& mode : state_.modes) {
      parts.push_back(numbers_of(mode.mean));
      parts.push_back(numbers_of(mode.covariance));
    }
    return parts;
  }
  void settle() {
    const Eigen::VectorXd& mu = state_.mode_probability;
    bool usable = mu.minCoeff() >= 0.0 && mu.sum() > 0.0 && std::isfinite(mu.sum());
    for (Gaussian<N>& mode : state_.modes) {
      usable = usable && mode.mean.allFinite() && is_covariance(mode.covariance);
      mode.known = model_->sensor.exact && mode.covariance.isZero(0.0);
    }
    if (!usable) throw std::invalid_argument("the snapshot has a state that is not finite or out of range");
  }

 private:
  std::shared_ptr<const Model> model_;
  FilterState<N> state_;
  // results of the last step, sized once
  std::vector<Gaussian<N>> mixed_;         ///< K
  std::vector<KalmanStep<N, NY>> kalman_;  ///< K
  MixingWeights mixing_;
  TransitionWorkspace transition_;
  Eigen::VectorXd predicted_probability_, log_likelihood_, weights_;  ///< K; c, log Lambda
  Sensor<N, NY> partial_;                                             ///< valid where signals are missing
  Gaussian<N> moments_;
  Eigen::Matrix<double, N, 1> difference_;
  Eigen::Matrix<double, NY, 1> y_, residual_;
  Eigen::Matrix<double, NY, NY> spread_;

  const Eigen::Matrix<double, N, 1>& combined_mean() {
    difference_.setZero();
    for (Eigen::Index i = 0; i < weights_.size(); ++i) difference_ += state_.mode_probability(i) * state_.modes[i].mean;
    return difference_;
  }

  /// Steps 1 and 2: start of each mode's prediction, and the mode probabilities before the measurement.
  void mix(const Vector& v) {
    const Eigen::VectorXd& mu = state_.mode_probability;
    predicted_probability_ = mu;
    if (model_->variant == FilterVariant::salvi2025)
      // Weights w(k-1)_i T_ij of [S25, eq. 12-13]. Their sum is below one, so mixed states shrink towards zero.
      mixing_.noalias() = mu.asDiagonal() * model_->bank.transition.matrix();
    else if (kalman_.size() > 1)
      mixing_weights(transition(v), mu, predicted_probability_, mixing_);
    const Gaussian<N>& first = state_.modes.front();
    const auto known = [&](const Gaussian<N>& mode) { return mode.known && mode.mean == first.mean; };
    if (kalman_.size() == 1 || std::all_of(state_.modes.begin(), state_.modes.end(), known))
      mixed_ = state_.modes;
    else
      modebank::merge<N>(state_.modes, mixing_, mixed_, model_->sensor.exact);
  }

  void skip_measurement() {
    for (std::size_t j = 0; j < kalman_.size(); ++j) state_.modes[j] = kalman_[j].predicted;
    state_.mode_probability = predicted_probability_;
    floor_probabilities(state_.mode_probability);
  }

  /// The filter as published in Salvi et al. (2025), arXiv 2505.00200, eq. 12-18: modes' probabilities are from log L_j
  /// = log N(C xhat_j - z; 0, S_j). As published in [S25, eq. 16], the residual is that after the update.
  void weigh_by_posterior() {
    for (Eigen::Index j = 0; j < weights_.size(); ++j) {
      small::multiply(residual_, sensor().C, state_.modes[j].mean);
      residual_ -= y_;
      log_likelihood_(j) = kalman_[j].log_normal(residual_);
    }
    bayes(predicted_probability_, log_likelihood_, state_.mode_probability);
  }
};

}  // namespace modebank
