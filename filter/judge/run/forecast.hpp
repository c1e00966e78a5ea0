#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/judge/run/drifting_forecast.hpp"
#include "filter/step/equations/filter_step.hpp"
#include "filter/step/equations/predicted_mixture.hpp"

/// Prediction without measurements: what a filter says of later samples from where it stands, with the inputs known.
namespace modebank {

/// The measurement so many model steps ahead as some model predicts it, each signal by itself and all jointly.
class Forecast {
 public:
  virtual ~Forecast() = default;
  /// One model step further under these acting inputs.
  virtual void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) = 0;
  /// Before what is asked below of a sample; `samples`: how many ahead it is, from 1 on.
  virtual void arrive(Eigen::Index /*samples*/) {}

  virtual Eigen::VectorXd mean() const = 0;                ///< n_y
  virtual Eigen::VectorXd standard_deviation() const = 0;  ///< n_y
  /// P(y_i <= y), and the y with that probability.
  virtual double probability(Eigen::Index i, double y) const = 0;
  virtual double quantile(Eigen::Index i, double probability) const = 0;
  /// Of all signals jointly [nats].
  virtual double log_density(const Eigen::Ref<const Eigen::VectorXd>& y) = 0;
  virtual Eigen::VectorXd mode_probability() const = 0;  ///< K

 protected:
  Forecast() = default;
  Forecast(const Forecast&) = default;
  Forecast& operator=(const Forecast&) = default;
};

/// A bank's moments: a Gaussian per mode, mixed (merged) as the filter does and propagated. With a constant transition
/// matrix every mode's probability, mean and covariance are exactly those of the switching system (moments of mixtures
/// merge without loss); that each mode's distribution is a Gaussian is the approximation. The one place where banks
/// predict without measuring.
template <int N, int NY>
class BankForecast {
 public:
  explicit BankForecast(const FilterModel<N, NY>& model)
      : model_(model),
        step_(model),
        state_(initial_state(model)),
        posterior_(step_.predicted_probability.size()),
        unused_(model.structure.dimension()) {}

  void start(const FilterState<N>& origin) {
    state_ = origin;
    ahead_ = contracted_ = false;
  }
  template <class U>
  void step(const U& inputs) {
    if (ahead_) skip_measurement(model_, step_, state_);
    if (ahead_ && !contracted_) contract();
    predict(model_, state_, inputs, step_);
    ahead_ = true;
  }

  const FilterModel<N, NY>& model() const { return model_; }
  const FilterStep<N, NY>& predicted() const { return step_; }

  /// Of a whole measurement [nats]; `error`: it minus the combined prediction.
  template <class Y, class Error>
  double observe(const Y& y, Error&& error) {
    error = y;
    for (std::size_t h = 0; h < step_.kalman.size(); ++h) {
      const auto i = static_cast<Eigen::Index>(h);
      if (model_.quantised)
        correct_intervals(model_, y, step_.kalman[h], unused_);
      else
        step_.kalman[h].observe(model_, y);
      step_.log_likelihood(i) = step_.kalman[h].log_density;
      error -= step_.predicted_probability(i) * (y - step_.kalman[h].innovation);
    }
    return bayes(step_.predicted_probability, step_.log_likelihood, posterior_);
  }

 private:
  const FilterModel<N, NY>& model_;
  FilterStep<N, NY> step_;
  FilterState<N> state_;
  Eigen::VectorXd posterior_;
  Gaussian<N> unused_;
  bool ahead_ = false, contracted_ = false;

  /// Coefficients that drifted to where they are unstable, good for one step, would run away in many; as
  /// DriftingForecast has it.
  void contract() {
    contracted_ = true;
    const LinearStructure& s = model_.structure;
    if (!model_.drift.on()) return;
    const Eigen::VectorXd units = Eigen::VectorXd::Ones(s.regressors());
    for (auto theta : state_.drift.theta.colwise())
      theta = contracted(s, units, theta.reshaped(s.regressors(), s.states)).reshaped();
  }
};

/// A mixture of normal distributions of one signal.
struct NormalMixture {
  Eigen::VectorXd weight, mean, deviation;

  double probability(double y) const {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < weight.size(); ++j) sum += weight(j) * normal_cdf((y - mean(j)) / deviation(j));
    return std::min(sum, 1.0);
  }
  /// `score`: the normal quantile of the probability. By bisection between the parts' own quantiles.
  double quantile(double probability_below, double score) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Eigen::Index j = 0; j < weight.size(); ++j) {
      if (!(weight(j) > negligible_weight)) continue;
      low = std::min(low, mean(j) + score * deviation(j));
      high = std::max(high, mean(j) + score * deviation(j));
    }
    constexpr int most_halvings = 200;
    constexpr double close = 1e-12;
    for (int i = 0; i < most_halvings && high - low > close * (std::abs(low) + std::abs(high)); ++i) {
      const double middle = 0.5 * (low + high);
      (probability(middle) < probability_below ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

 private:
  static constexpr double negligible_weight = 1e-9;  ///< at the edge of the bands that anyone asks for
};

}  // namespace modebank
