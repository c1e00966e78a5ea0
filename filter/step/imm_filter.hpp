#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "filter/step/imm.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/covariance.hpp"

namespace modebank {

/// The filter of a bank with the state and the workspace of a step, in fixed or dynamic size (imm.hpp). Call `start`
/// first, then `predict` and `update` for each sample. Nothing is allocated after construction.
///
/// A copy of it is a forecast: `step` predicts on without measurements. As in the filter, the Gaussians of the modes
/// are mixed and propagated in each step. If the transition matrix is constant, every mode's probability, mean and
/// covariance are exact, because moments of mixtures merge exactly. Only the distribution of each mode is approximated
/// by a Gaussian.
template <int N, int NY>
class ImmFilter {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// Requires check_sizes(bank). Throws std::invalid_argument for options that do not suit this bank.
  ImmFilter(const Bank& bank, const FilterOptions& options)
      : model_(std::make_shared<const FilterModel<N, NY>>(bank, options)),
        step_(*model_),
        state_(initial_state(*model_)),
        moments_(model_->structure.dimension()),
        weights_(model_->mode_count()) {}

  /// Starts from the first measurement `y`; with lags, from the first complete z.
  void start(const Vector& y) { modebank::start(*model_, y, state_); }
  /// Starts a forecast from a filter of the same bank.
  void start(const ImmFilter& origin) { state_ = origin.state_; }
  /// Predicts the next sample, one model step later, under the acting inputs `v`.
  void predict(const Vector& v) { modebank::predict(*model_, state_, v, step_); }
  /// One model step without a measurement.
  void step(const Vector& v) {
    predict(v);
    skip_measurement(step_, state_);
  }
  /// Updates with `y`. Returns the log predictive density [nats] of the available signals; NaN if there are none.
  double update(const Vector& y) { return modebank::update(*model_, y, step_, state_); }

  const FilterModel<N, NY>& model() const { return *model_; }
  const FilterState<N>& state() const { return state_; }
  const Eigen::VectorXd& mode_probability() const { return state_.mode_probability; }           ///< K
  const Eigen::VectorXd& predicted_probability() const { return step_.predicted_probability; }  ///< K
  const Eigen::VectorXd& log_likelihood() const { return step_.log_likelihood; }  ///< K, of the last measurement
  /// T of the next step under the acting inputs `v`.
  const Eigen::MatrixXd& transition(const Vector& v) { return transition_of_step(*model_, state_, v, step_); }

  /// Moments of the predicted mixture, n and n_y x n_y: x = sum c_j x_j, S = sum c_j (S_j + (e_j - e)(e_j - e)'). Call
  /// after `predict`.
  void combine(Eigen::VectorXd& state, Eigen::MatrixXd& innovation_covariance) {
    const Eigen::VectorXd& c = step_.predicted_probability;
    step_.mean.setZero();
    for (std::size_t j = 0; j < step_.kalman.size(); ++j)
      step_.mean += c(static_cast<Eigen::Index>(j)) * step_.kalman[j].predicted.mean;
    step_.spread.setZero();
    for (std::size_t j = 0; j < step_.kalman.size(); ++j) {
      step_.difference = step_.kalman[j].predicted.mean - step_.mean;
      small::multiply(step_.residual, model_->C, step_.difference);
      small::add_about_mean(step_.spread, c(static_cast<Eigen::Index>(j)), step_.kalman[j].innovation_covariance,
                            step_.residual);
    }
    state = step_.mean;
    innovation_covariance = step_.spread;
  }
  /// Probability integral transform of the last measurement y (Rosenblatt 1952). Component i is the predictive
  /// distribution function at y_i, given the earlier signals y_1 .. y_(i-1), which have updated the mixture weights.
  /// NaN if y_i is missing. For a rounded signal it lies between the values at both ends of y_i's interval: `pit` is
  /// their mean and `width` their difference, else 0. `log_density`: that of `update`; if signals are rounded it
  /// becomes that of their intervals. Overwrites log_likelihood().
  void transform(const Vector& y, Eigen::VectorXd& pit, Eigen::VectorXd& width, double& log_density) {
    const bool rounded = model_->quantum.size() > 0;
    double of_intervals = 0.0;
    weights_ = step_.predicted_probability;
    width.setZero();
    for (Eigen::Index i = 0; i < pit.size(); ++i) {
      pit(i) = std::numeric_limits<double>::quiet_NaN();
      if (is_missing(y(i))) continue;
      const bool scores = rounded || i + 1 < pit.size();
      const double quantum = rounded ? model_->quantum(i) : 0.0, half = 0.5 * quantum;
      double low = 0.0, high = 0.0;
      for (Eigen::Index j = 0; j < weights_.size(); ++j) {
        const KalmanStep<N, NY>& mode = step_.kalman[static_cast<std::size_t>(j)];
        const ModeSignal signal{mode.decorrelated(i), mode.cholesky.D(i)};
        const double deviation = signal.unrounded_deviation(quantum);
        high += weights_(j) * normal_cdf((signal.e + half) / deviation);
        if (quantum > 0.0) low += weights_(j) * normal_cdf((signal.e - half) / deviation);
        if (scores) step_.log_likelihood(j) = signal.log_density(quantum);
      }
      high = high < 1.0 ? high : 1.0;  // limits rounding errors of the sum of weights
      low = quantum > 0.0 ? std::min(low, high) : high;
      pit(i) = 0.5 * (low + high);
      width(i) = high - low;
      if (scores) of_intervals += bayes(weights_, step_.log_likelihood, weights_);
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
  /// Log density of a complete measurement [nats]; `error`: measurement minus combined prediction. Changes no state.
  template <class Y, class Error>
  double observe(const Y& y, Error&& error) {
    error = y;
    for (std::size_t h = 0; h < step_.kalman.size(); ++h) {
      const auto i = static_cast<Eigen::Index>(h);
      step_.kalman[h].observe(*model_, y);
      step_.log_likelihood(i) = log_density(step_.kalman[h]);
      error -= step_.predicted_probability(i) * (y - step_.kalman[h].innovation);
    }
    return bayes(step_.predicted_probability, step_.log_likelihood, weights_);
  }
  /// Predicted distribution of signal i, whatever the other signals are.
  SignalMixture signal(Eigen::Index i) const {
    SignalMixture result{step_.predicted_probability, step_.predicted_probability, step_.predicted_probability};
    for (std::size_t h = 0; h < step_.kalman.size(); ++h) {
      const auto j = static_cast<Eigen::Index>(h);
      result.mean(j) = model_->C.row(i).dot(step_.kalman[h].predicted.mean);
      result.deviation(j) = std::sqrt(std::max(step_.kalman[h].innovation_covariance(i, i), least_variance));
    }
    return result;
  }

  /// The parts of a snapshot. After they have been read, `settle` checks them.
  auto parts() { return std::tie(state_.modes, state_.mode_probability); }
  /// Throws std::invalid_argument if the state is none.
  void settle() {
    const Eigen::VectorXd& probability = state_.mode_probability;
    bool finite = probability.allFinite() && probability.minCoeff() >= 0.0 && probability.sum() > 0.0 &&
                  std::isfinite(probability.sum());
    for (const Gaussian<N>& mode : state_.modes)
      finite = finite && mode.mean.allFinite() && mode.covariance.allFinite();
    if (!finite) throw std::invalid_argument("the snapshot has a number that is not finite or out of range");
    for (const Gaussian<N>& mode : state_.modes)
      if (!is_covariance(mode.covariance))
        throw std::invalid_argument("the snapshot has a matrix that is not a covariance");
    for (Gaussian<N>& mode : state_.modes) mode.known = model_->exact && mode.covariance.isZero(0.0);
  }

 private:
  std::shared_ptr<const FilterModel<N, NY>> model_;
  FilterStep<N, NY> step_;
  FilterState<N> state_;
  Gaussian<N> moments_;
  Eigen::VectorXd weights_;

  /// Log density of the observed measurement in one mode, with the masses of intervals for rounded signals.
  double log_density(const KalmanStep<N, NY>& mode) const {
    if (model_->quantum.size() == 0) return mode.log_density;
    double sum = 0.0;
    for (Eigen::Index i = 0; i < model_->quantum.size(); ++i)
      sum += ModeSignal{mode.decorrelated(i), mode.cholesky.D(i)}.log_density(model_->quantum(i));
    return sum;
  }
};

}  // namespace modebank
