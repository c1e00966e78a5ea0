#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "filter/filter_model.hpp"
#include "filter/gaussian.hpp"
#include "filter/imm.hpp"
#include "filter/kalman.hpp"
#include "filter/measurement.hpp"
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

/// What one step computes on the way, sized once. A hypothesis is what a mode predicts from: one per mode, and with
/// GPB2 one per pair of modes, hypothesis j K + i being mode j from mode i.
template <int N, int NY>
struct FilterStep {
  Eigen::VectorXd predicted_probability;  ///< K, c: before the measurement
  std::vector<KalmanStep<N, NY>> kalman;  ///< one per hypothesis
  std::vector<Gaussian<N>> mixed;         ///< K, where each mode's prediction starts
  MixingWeights mixing;
  Eigen::VectorXd log_likelihood;          ///< of each hypothesis
  PartialSensor<N, NY> partial;            ///< of the last measurement; `missing` is 0 when that was whole
  Eigen::Matrix<double, N, 1> difference;  ///< workspace of size n
  Eigen::Matrix<double, NY, 1> residual;   ///< workspace of size n_y

  // GPB2 alone; empty otherwise.
  Eigen::VectorXd pair_probability;    ///< K^2, before the measurement
  std::vector<Gaussian<N>> corrected;  ///< K^2
  Eigen::VectorXd merging;             ///< K, workspace
  Eigen::VectorXd mode_likelihood;     ///< K, workspace: log p(y | mode)

  explicit FilterStep(const FilterModel<N, NY>& model)
      : predicted_probability(model.mode_count()),
        partial(model.structure.dimension(), model.C.rows()),
        difference(model.structure.dimension()),
        residual(model.C.rows()) {
    const Eigen::Index K = model.mode_count(), n = model.structure.dimension();
    const bool pairs = model.variant == FilterVariant::gpb2 && K > 1;
    const Eigen::Index hypotheses = pairs ? K * K : K;
    kalman.assign(static_cast<std::size_t>(hypotheses),
                  KalmanStep<N, NY>(n, model.C.rows(), model.structure.regressors()));
    log_likelihood.resize(hypotheses);
    mixed.assign(model.modes.size(), Gaussian<N>(n));
    mixing.matrix.setZero(K, K);
    if (!pairs) return;
    pair_probability.resize(hypotheses);
    corrected.assign(kalman.size(), Gaussian<N>(n));
    merging.resize(K);
    mode_likelihood.resize(K);
  }

  bool pairs() const { return pair_probability.size() > 0; }
  /// How probable each hypothesis is before the measurement; sums to one.
  const Eigen::VectorXd& hypothesis_probability() const { return pairs() ? pair_probability : predicted_probability; }
};

/// A state of the model's sizes.
template <int N, int NY>
FilterState<N> initial_state(const FilterModel<N, NY>& model) {
  return {std::vector<Gaussian<N>>(model.modes.size(), Gaussian<N>(model.structure.dimension())),
          model.initial_probability};
}

/// x[0] = start_gain y[0], P[0] = start_covariance, mode probabilities from the bank. `y`: the first measurement; with
/// lags the first whole z of measurements.
template <int N, int NY, class Y>
void start(const FilterModel<N, NY>& model, const Y& y, FilterState<N>& state) {
  small::multiply(state.modes[0].mean, model.start_gain, y);
  state.modes[0].covariance = model.start_covariance;
  for (std::size_t j = 1; j < state.modes.size(); ++j) state.modes[j] = state.modes[0];
  state.mode_probability = model.initial_probability;
  floor_probabilities(state.mode_probability);
  state.noise_scale = 1.0;
  state.noise_samples = model.noise_adaptation.prior_samples;
}

template <int N, int NY, class Y>
FilterState<N> start(const FilterModel<N, NY>& model, const Y& y) {
  FilterState<N> state = initial_state(model);
  start(model, y, state);
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
  if (model.variant == FilterVariant::gpb1) {
    merge(state.modes, state.mode_probability, step.mixed[0]);
    for (std::size_t j = 1; j < step.mixed.size(); ++j) step.mixed[j] = step.mixed[0];
    return step.mixed;
  }
  for (std::size_t j = 0; j < step.mixed.size(); ++j)
    merge(state.modes, step.mixing.matrix.col(static_cast<Eigen::Index>(j)), step.mixed[j]);
  return step.mixed;
}

/// Every mode j from every mode i, of probability T_ij mu_i.
template <int N, int NY, class U>
void predict_pairs(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u, FilterStep<N, NY>& step) {
  mixing_weights(model.transition, state.mode_probability, step.predicted_probability, step.mixing);
  const std::size_t K = model.modes.size();
  for (std::size_t j = 0; j < K; ++j)
    for (std::size_t i = 0; i < K; ++i) {
      const auto from = static_cast<Eigen::Index>(i), to = static_cast<Eigen::Index>(j);
      step.pair_probability(to * static_cast<Eigen::Index>(K) + from) =
          model.transition.matrix()(from, to) * state.mode_probability(from);
      step.kalman[j * K + i].predict(state.modes[i], model, model.modes[j], u, state.noise_scale);
      step.kalman[j * K + i].expect(model);
    }
}

/// Fills what is known before the measurement: each hypothesis' prediction and S, and the predicted probabilities.
template <int N, int NY, class U>
void predict(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u, FilterStep<N, NY>& step) {
  if (step.pairs()) return predict_pairs(model, state, u, step);
  const std::vector<Gaussian<N>>& from = mix(model, state, step);
  for (std::size_t j = 0; j < model.modes.size(); ++j) {
    step.kalman[j].predict(from[j], model, model.modes[j], u, state.noise_scale);
    step.kalman[j].expect(model);
  }
}

/// The K estimates that lead to mode j, of a list over pairs.
template <int N>
std::span<const Gaussian<N>> towards(const std::vector<Gaussian<N>>& pairs, std::size_t j, std::size_t K) {
  return std::span<const Gaussian<N>>(pairs).subspan(j * K, K);
}

/// A missing measurement: the prediction is all there is.
template <int N, int NY>
void skip_measurement(FilterStep<N, NY>& step, FilterState<N>& state) {
  const std::size_t K = state.modes.size();
  if (step.pairs()) {
    for (std::size_t h = 0; h < step.kalman.size(); ++h) step.corrected[h] = step.kalman[h].predicted;
    for (std::size_t j = 0; j < K; ++j)
      merge(towards(step.corrected, j, K), step.mixing.matrix.col(static_cast<Eigen::Index>(j)), state.modes[j]);
  } else {
    for (std::size_t j = 0; j < K; ++j) state.modes[j] = step.kalman[j].predicted;
  }
  state.mode_probability = step.predicted_probability;
  floor_probabilities(state.mode_probability);
}

/// What the pairs say together after the measurement: one estimate per mode, and the modes' probabilities.
template <int N, int NY>
double merge_pairs(FilterStep<N, NY>& step, FilterState<N>& state) {
  const std::size_t K = state.modes.size();
  for (std::size_t j = 0; j < K; ++j) {
    const auto mode = static_cast<Eigen::Index>(j), first = static_cast<Eigen::Index>(j * K);
    const auto prior = step.mixing.matrix.col(mode);
    step.mode_likelihood(mode) =
        bayes(prior, step.log_likelihood.segment(first, static_cast<Eigen::Index>(K)), step.merging);
    merge(towards(step.corrected, j, K), step.merging, state.modes[j]);
  }
  return bayes(step.predicted_probability, step.mode_likelihood, state.mode_probability);
}

/// Every hypothesis takes the measurement `y` of `sensor` in: its estimate after it and its log likelihood.
template <int N, int NY, class Sensor, class Y>
void correct(const Sensor& sensor, const Y& y, FilterStep<N, NY>& step, std::vector<Gaussian<N>>& estimates) {
  constexpr double half_log_two_pi = 0.91893853320467274178;
  const double excess = half_log_two_pi * static_cast<double>(step.partial.missing);
  for (std::size_t h = 0; h < step.kalman.size(); ++h) {
    step.kalman[h].observe(sensor, y);
    step.kalman[h].correct(sensor, estimates[h]);
    step.log_likelihood(static_cast<Eigen::Index>(h)) = step.kalman[h].log_density + excess;
  }
}

/// Takes the measurement in after `predict` and returns the log predictive density of its signals that are there, which
/// uses nothing but what was known before it. Without any signal that is a prediction only; the result is then NaN.
template <int N, int NY, class Y>
double update(const FilterModel<N, NY>& model, const Y& y, FilterStep<N, NY>& step, FilterState<N>& state) {
  const Eigen::Index missing = missing_entries(y);
  step.partial.missing = missing;
  if (missing == y.size()) {
    skip_measurement(step, state);
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<Gaussian<N>>& estimates = step.pairs() ? step.corrected : state.modes;
  if (missing > 0) {
    step.partial.assign(model, y);
    for (KalmanStep<N, NY>& hypothesis : step.kalman) hypothesis.expect(step.partial);
    correct(step.partial, step.partial.y, step, estimates);
    if (model.adaptive) adapt_noise_scale(model, step.partial, step.hypothesis_probability(), step, state);
  } else {
    correct(model, y, step, estimates);
    if (model.adaptive) adapt_noise_scale(model, model, step.hypothesis_probability(), step, state);
  }
  if (model.mode_count() == 1) return step.log_likelihood(0);
  const double log_density = step.pairs()
                                 ? merge_pairs(step, state)
                                 : bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
  if (model.variant == FilterVariant::salvi2025) {
    for (std::size_t j = 0; j < model.modes.size(); ++j) {
      double& log_likelihood = step.log_likelihood(static_cast<Eigen::Index>(j));
      const KalmanStep<N, NY>& kalman = step.kalman[j];
      log_likelihood =
          missing > 0 ? salvi2025::log_likelihood(step.partial, kalman, state.modes[j], step.partial.y, step.residual)
                      : salvi2025::log_likelihood(model, kalman, state.modes[j], y, step.residual);
    }
    bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
  }
  floor_probabilities(state.mode_probability);
  return log_density;
}

}  // namespace modebank
