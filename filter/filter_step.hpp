#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/filter_model.hpp"
#include "filter/gaussian.hpp"
#include "filter/imm.hpp"
#include "filter/kalman.hpp"
#include "filter/noise_scale.hpp"
#include "filter/salvi2025.hpp"

/// One step of the filters of FilterVariant, a function of model, state, input and measurement: nothing is remembered
/// between calls but FilterState, and nothing is allocated once FilterState and FilterStep exist.
namespace modebank {

/// All that a filter knows: one Gaussian per mode, how probable each mode is, and the present scale of the noise.
template <int N>
struct FilterState {
  std::vector<Gaussian<N>> modes;    ///< K
  Eigen::VectorXd mode_probability;  ///< K
  double noise_scale = 1.0;          ///< multiplies every mode's Q in the next prediction
  double noise_samples = 0.0;        ///< how many samples the scale rests on (noise_scale.hpp)
};

/// What one step computes on the way, sized once.
template <int N, int NY>
struct FilterStep {
  Eigen::VectorXd predicted_probability;  ///< K, c: before the measurement
  std::vector<KalmanStep<N, NY>> kalman;  ///< K
  std::vector<Gaussian<N>> mixed;         ///< K, where each mode's prediction starts
  MixingWeights mixing;
  Eigen::VectorXd log_likelihood;          ///< K
  Eigen::Matrix<double, N, 1> difference;  ///< workspace of size n
  Eigen::Matrix<double, NY, 1> residual;   ///< workspace of size n_y

  explicit FilterStep(const FilterModel<N, NY>& model)
      : predicted_probability(model.mode_count()),
        log_likelihood(model.mode_count()),
        difference(model.structure.dimension()),
        residual(model.C.rows()) {
    const Eigen::Index K = model.mode_count(), n = model.structure.dimension();
    kalman.assign(model.modes.size(), KalmanStep<N, NY>(n, model.C.rows(), model.structure.regressors()));
    mixed.assign(model.modes.size(), Gaussian<N>(n));
    mixing.matrix.setZero(K, K);
  }
};

/// x[0] = start_gain y[0], P[0] = start_covariance, mode probabilities from the bank. `y`: the first measurement; with
/// lags the first whole z of measurements.
template <int N, int NY, class Y>
FilterState<N> start(const FilterModel<N, NY>& model, const Y& y) {
  Gaussian<N> first(model.structure.dimension());
  small::multiply(first.mean, model.start_gain, y);
  first.covariance = model.start_covariance;
  FilterState<N> state{std::vector<Gaussian<N>>(model.modes.size(), first), model.initial_probability};
  floor_probabilities(state.mode_probability);
  state.noise_samples = model.noise_adaptation.prior_samples;
  return state;
}

/// Where each mode's prediction starts, and how probable each mode is before the measurement.
template <int N, int NY>
const std::vector<Gaussian<N>>& mix(const FilterModel<N, NY>& model, const FilterState<N>& state,
                                    FilterStep<N, NY>& step) {
  if (model.variant == FilterVariant::mmae || model.mode_count() == 1) {
    step.predicted_probability = state.mode_probability;
    return state.modes;
  }
  if (model.variant == FilterVariant::salvi2025) {
    step.predicted_probability = state.mode_probability;
    salvi2025::mixing_weights(model.transition, state.mode_probability, step.mixing);
  } else {
    mixing_weights(model.transition, state.mode_probability, step.predicted_probability, step.mixing);
  }
  for (std::size_t j = 0; j < step.mixed.size(); ++j)
    merge(state.modes, step.mixing.matrix.col(static_cast<Eigen::Index>(j)), step.mixed[j]);
  return step.mixed;
}

/// Fills what is known before the measurement: each mode's prediction and S, and the predicted probabilities.
template <int N, int NY, class U>
void predict(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u, FilterStep<N, NY>& step) {
  const std::vector<Gaussian<N>>& from = mix(model, state, step);
  for (std::size_t j = 0; j < model.modes.size(); ++j) {
    step.kalman[j].predict(from[j], model, model.modes[j], u, state.noise_scale);
    step.kalman[j].expect(model);
  }
}

/// A missing measurement: the prediction is all there is.
template <int N, int NY>
void skip_measurement(const FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < step.kalman.size(); ++j) state.modes[j] = step.kalman[j].predicted;
  state.mode_probability = step.predicted_probability;
  floor_probabilities(state.mode_probability);
}

/// Takes the measurement in after `predict` and returns its log predictive density, which uses nothing but what was
/// known before it.
template <int N, int NY, class Y>
double update(const FilterModel<N, NY>& model, const Y& y, FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < model.modes.size(); ++j) {
    step.kalman[j].observe(model, y);
    step.kalman[j].correct(model, state.modes[j]);
    step.log_likelihood(static_cast<Eigen::Index>(j)) = step.kalman[j].log_density;
  }
  if (model.adaptive) adapt_noise_scale(model, model, step.predicted_probability, step, state);
  if (model.mode_count() == 1) return step.log_likelihood(0);
  const double log_density = bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
  if (model.variant == FilterVariant::salvi2025) {
    for (std::size_t j = 0; j < model.modes.size(); ++j)
      step.log_likelihood(static_cast<Eigen::Index>(j)) =
          salvi2025::log_likelihood(model, step.kalman[j], state.modes[j], y, step.residual);
    bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
  }
  floor_probabilities(state.mode_probability);
  return log_density;
}

/// Measurements at or beyond this magnitude, infinite or NaN count as missing: nothing can be learned from them.
inline constexpr double largest_measurement = 1e30;

template <class Y>
bool is_missing(const Y& y) {
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (!(std::abs(y(i)) < largest_measurement)) return true;
  return false;
}

}  // namespace modebank
