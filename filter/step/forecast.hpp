#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "filter/step/bank_filter.hpp"
#include "filter/step/drifting_forecast.hpp"
#include "filter/step/equations/filter_step.hpp"
#include "filter/step/equations/predicted_mixture.hpp"
#include "filter/step/feed/run_samples.hpp"

/// Predictions without measurements, from a filter's state and with known inputs: BankForecast (moments of a bank) and
/// DriftingForecast (running noise). Forecaster applies them to planned inputs, judge/run/forecast.hpp to recorded
/// runs.
namespace modebank {

/// Forecast of a bank by moments: one Gaussian per mode. As in the filter, the Gaussians are mixed and propagated in
/// each step. If the transition matrix is constant, every mode's probability, mean and covariance are exact, because
/// moments of mixtures merge exactly. Only the distribution of each mode is approximated by a Gaussian.
template <int N, int NY>
class BankForecast {
 public:
  explicit BankForecast(const FilterModel<N, NY>& model)
      : model_(model), step_(model), state_(initial_state(model)), posterior_(step_.predicted_probability.size()) {}

  void start(const FilterState<N>& origin) {
    state_ = origin;
    ahead_ = false;
  }
  template <class U>
  void step(const U& inputs) {
    if (ahead_) skip_measurement(step_, state_);
    predict(model_, state_, inputs, step_);
    ahead_ = true;
  }

  const FilterStep<N, NY>& predicted() const { return step_; }

  /// Mean and covariance of the predicted state, combined over all modes.
  template <class Mean, class Covariance>
  void moments(Mean&& mean, Covariance&& covariance) const {
    const auto each = [&](auto add) {
      for (std::size_t j = 0; j < step_.kalman.size(); ++j)
        add(step_.predicted_probability(static_cast<Eigen::Index>(j)), step_.kalman[j].predicted);
    };
    mean.setZero();
    each([&](double weight, const Gaussian<N>& mode) { mean += weight * mode.mean; });
    covariance.setZero();
    each([&](double weight, const Gaussian<N>& mode) {
      const Eigen::Matrix<double, N, 1> apart = mode.mean - mean;
      small::add_about_mean(covariance, weight, mode.covariance, apart);
    });
  }

  /// Log density of a complete measurement [nats]; `error`: measurement minus combined prediction.
  template <class Y, class Error>
  double observe(const Y& y, Error&& error) {
    error = y;
    for (std::size_t h = 0; h < step_.kalman.size(); ++h) {
      const auto i = static_cast<Eigen::Index>(h);
      step_.kalman[h].observe(model_, y);
      step_.log_likelihood(i) = log_density(step_.kalman[h]);
      error -= step_.predicted_probability(i) * (y - step_.kalman[h].innovation);
    }
    return bayes(step_.predicted_probability, step_.log_likelihood, posterior_);
  }

  /// Distribution of signal i, whatever the other signals are.
  NormalMixture signal(Eigen::Index i) const {
    NormalMixture result{step_.predicted_probability, step_.predicted_probability, step_.predicted_probability};
    for (std::size_t h = 0; h < step_.kalman.size(); ++h) {
      const auto j = static_cast<Eigen::Index>(h);
      result.mean(j) = model_.C.row(i).dot(step_.kalman[h].predicted.mean);
      result.deviation(j) = std::sqrt(std::max(step_.kalman[h].innovation_covariance(i, i), least_variance));
    }
    return result;
  }

 private:
  const FilterModel<N, NY>& model_;
  FilterStep<N, NY> step_;
  FilterState<N> state_;
  Eigen::VectorXd posterior_;
  bool ahead_ = false;

  /// Log density of the observed measurement in one mode, with the masses of intervals for rounded signals.
  double log_density(const KalmanStep<N, NY>& mode) const {
    if (model_.quantum.size() == 0) return mode.log_density;
    double sum = 0.0;
    for (Eigen::Index i = 0; i < model_.quantum.size(); ++i)
      sum += ModeSignal{mode.decorrelated(i), mode.cholesky.D(i)}.log_density(model_.quantum(i));
    return sum;
  }
};

/// Prediction of one later sample, combined over all modes.
struct StateForecast {
  Eigen::VectorXd state;             ///< n
  Eigen::MatrixXd covariance;        ///< n x n
  Eigen::VectorXd mode_probability;  ///< K
};

/// Forecasts of a bank of any size under planned inputs.
class Forecaster {
 public:
  /// The conditions are those of BankFilter.
  Forecaster(const Bank& bank, const FilterOptions& options);
  ~Forecaster();

  /// Predicts the next `steps` samples, one model step apart, from a filter state of this bank. Column i of `inputs` (m
  /// x c) is the input recorded at the sample i + 1 ahead. Inputs act input_delay samples later, so as many of the
  /// last columns as the earliest input is late have no effect and may be omitted. Before the filter's start, states
  /// are NaN. Throws std::invalid_argument for too few inputs, for inputs that are not finite, and for steps below 1.
  std::vector<StateForecast> ahead(const FilterSnapshot& from, const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                   Eigen::Index steps);

 private:
  struct Sized;
  template <int N, int NY>
  struct OfSize;
  struct OfRunningNoise;
  static std::unique_ptr<Sized> sized(const Bank& bank, const FilterOptions& options);
  std::unique_ptr<Sized> sized_;
  Eigen::Index inputs_, earliest_input_, measurements_;
  SampleFeed feed_;
};

}  // namespace modebank
