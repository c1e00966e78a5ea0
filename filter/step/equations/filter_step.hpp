#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "filter/step/equations/imm.hpp"
#include "filter/step/equations/salvi2025.hpp"

/// One step of the filters of FilterVariant, as a function of model, state, input and measurement. Only FilterState
/// persists between calls. Nothing is allocated once FilterState and FilterStep exist. Call `start` first. For each
/// sample call `predict`, then `update`, or `skip_measurement` if no signal was measured.
namespace modebank {

/// A state with the sizes of the model.
template <int N, int NY>
FilterState<N> initial_state(const FilterModel<N, NY>& model) {
  return {std::vector<Gaussian<N>>(model.modes.size(), Gaussian<N>(model.structure.dimension())),
          model.initial_probability};
}

/// x[0] = start_gain y[0], P[0] = start_covariance, mode probabilities from the bank. `y`: first measurement; with lags
/// the first complete z of measurements.
template <int N, int NY, class Y>
void start(const FilterModel<N, NY>& model, const Y& y, FilterState<N>& state) {
  small::multiply(state.modes[0].mean, model.start_gain, y);
  state.modes[0].covariance = model.start_covariance;
  state.modes[0].uncertain = model.exact ? 0 : model.structure.dimension();
  for (std::size_t j = 1; j < state.modes.size(); ++j) state.modes[j] = state.modes[0];
  state.mode_probability = model.initial_probability;
  floor_probabilities(state.mode_probability);
}

template <int N, int NY, class Y>
FilterState<N> start(const FilterModel<N, NY>& model, const Y& y) {
  FilterState<N> state = initial_state(model);
  start(model, y, state);
  return state;
}

/// Start of each mode's prediction, and the mode probabilities before the measurement.
template <int N, int NY, class U>
const std::vector<Gaussian<N>>& mix(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u,
                                    FilterStep<N, NY>& step) {
  if (model.mode_count() == 1) {
    step.predicted_probability = state.mode_probability;
    return state.modes;
  }
  if (model.variant == FilterVariant::salvi2025) {
    step.predicted_probability = state.mode_probability;
    salvi2025::mixing_weights(model.transition, state.mode_probability, step.mixing);
  } else {
    mixing_weights(transition_of_step(model, state, u, step), state.mode_probability, step.predicted_probability,
                   step.mixing);
  }
  merge<N>(state.modes, step.mixing.matrix, step.mixed, model.exact);
  return step.mixed;
}

/// Computes everything before the measurement: each mode's prediction and S, and the predicted probabilities.
template <int N, int NY, class U>
void predict(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u, FilterStep<N, NY>& step) {
  predict_modes(model, mix(model, state, u, step), noise_of_step(model, state, u, step), u, step);
}

/// For a missing measurement: the prediction becomes the estimate.
template <int N, int NY>
void skip_measurement(FilterStep<N, NY>& step, FilterState<N>& state) {
  keep_prediction(step, state);
  state.mode_probability = step.predicted_probability;
  floor_probabilities(state.mode_probability);
}

/// Updates with a measurement. `sensor` is the model, or its part for the available signals.
template <int N, int NY, class Sensor, class Y>
double take_in(const FilterModel<N, NY>& model, const Sensor& sensor, const Y& y, FilterStep<N, NY>& step,
               FilterState<N>& state) {
  correct(sensor, y, step, state.modes);
  if (model.mode_count() == 1) return step.log_likelihood(0);
  const double log_density = bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
  if (model.variant == FilterVariant::salvi2025) salvi2025::weigh_by_posterior(sensor, y, step, state);
  floor_probabilities(state.mode_probability);
  return log_density;
}

/// Updates with the measurement after `predict`. Returns the log predictive density of the available signals. The
/// density uses only information from before the measurement. If all signals are missing, the prediction becomes the
/// estimate, and the result is NaN.
template <int N, int NY, class Y>
double update(const FilterModel<N, NY>& model, const Y& y, FilterStep<N, NY>& step, FilterState<N>& state) {
  step.partial.missing = missing_entries(y);
  if (step.partial.missing == 0) return take_in(model, model, y, step, state);
  if (step.partial.missing == y.size()) {
    skip_measurement(step, state);
    return std::numeric_limits<double>::quiet_NaN();
  }
  step.partial.assign(model, y);
  for (KalmanStep<N, NY>& mode : step.kalman) mode.expect(step.partial);
  return take_in(model, step.partial, step.partial.y, step, state);
}

}  // namespace modebank
