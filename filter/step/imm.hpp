#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "filter/step/gaussian.hpp"
#include "filter/step/kalman.hpp"
#include "ident/base/log_two_pi.hpp"

/// The interacting multiple model filter: Blom & Bar-Shalom 1988, "The interacting multiple model algorithm for systems
/// with Markovian switching coefficients", IEEE Transactions on Automatic Control 33(8). Equation numbers are those of
/// Bar-Shalom, Li & Kirubarajan 2001, "Estimation with Applications to Tracking and Navigation", section 11.6.6. Its
/// five steps are:
///   1  mixing probabilities    mixing_weights
///   2  mixing                  mix
///   3  mode-matched filtering  predict, take_in (kalman.hpp)
///   4  mode probabilities      take_in, bayes, floor_probabilities
///   5  combination             merge
/// The book leaves some cases open: modes that T forbids, likelihoods that underflow, missing signals. Comments below
/// state how each is handled. The functions at the end combine the steps to those of FilterVariant. Only FilterState
/// persists between calls. Nothing is allocated once FilterState and FilterStep exist. Call `start` first. For each
/// sample call `predict`, then `update`, or `skip_measurement` if no signal was measured.
namespace modebank {

/// The state of a filter: one Gaussian per mode, and the mode probabilities.
template <int N>
struct FilterState {
  std::vector<Gaussian<N>> modes;    ///< K
  Eigen::VectorXd mode_probability;  ///< K, mu
};

/// Column j holds mu_{i|j}, the weight of each mode i in the start of mode j. Unlike in a TransitionMatrix, the columns
/// sum to one. Rows are contiguous: merge computes several columns at a time.
using MixingWeights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // K x K

/// Intermediate results of one step, sized once.
template <int N, int NY>
struct FilterStep {
  Eigen::VectorXd predicted_probability;  ///< K mode probabilities before the measurement (c)
  std::vector<KalmanStep<N, NY>> kalman;  ///< K
  std::vector<Gaussian<N>> mixed;         ///< K, start of each mode's prediction
  MixingWeights mixing;
  TransitionWorkspace transition;
  Eigen::VectorXd log_likelihood;          ///< K
  PartialSensor<N, NY> partial;            ///< sensor of the last measurement; `missing` is 0 if it was complete
  Eigen::Matrix<double, N, 1> mean;        ///< of the predicted mixture
  Eigen::Matrix<double, NY, NY> spread;    ///< of the predicted measurement
  Eigen::Matrix<double, N, 1> difference;  ///< workspace of size n
  Eigen::Matrix<double, NY, 1> residual;   ///< workspace of size n_y

  explicit FilterStep(const FilterModel<N, NY>& model)
      : predicted_probability(model.mode_count()),
        transition(model.mode_count(), model.transition_logit),
        partial(model.structure.dimension(), model.C.rows()),
        mean(model.structure.dimension()),
        spread(model.C.rows(), model.C.rows()),
        difference(model.structure.dimension()),
        residual(model.C.rows()) {
    const Eigen::Index K = model.mode_count(), n = model.structure.dimension();
    kalman.assign(model.modes.size(),
                  KalmanStep<N, NY>(n, model.C.rows(), model.terms.empty() ? 0 : model.structure.regressors()));
    log_likelihood.resize(K);
    mixed.assign(model.modes.size(), Gaussian<N>(n));
    mixing.setZero(K, K);
  }
};

/// The mean of the combined estimate.
template <int N>
void combine_means(const FilterState<N>& state, Eigen::Matrix<double, N, 1>& mean) {
  mean.setZero();
  for (std::size_t i = 0; i < state.modes.size(); ++i)
    mean += state.mode_probability(static_cast<Eigen::Index>(i)) * state.modes[i].mean;
}

/// T of the step from `state` under the acting inputs `u`. A logit is evaluated at the combined estimate. This is exact
/// if states are measured exactly.
template <int N, int NY, class U>
const Eigen::MatrixXd& transition_of_step(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u,
                                          FilterStep<N, NY>& step) {
  if (model.transition_logit.empty()) return model.transition.matrix();
  combine_means(state, step.difference);
  return transition_at(model.transition.matrix(), model.transition_logit, step.difference, u, step.transition);
}

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
/// (11.6.6-17, -18). Differences of means are relative to the final mean. The sum of the weights may differ from one,
/// because the filter of [S25, eq. 12-13] uses other weights. `exact`: see FilterModel. With it, a row with the same
/// mean in all parts keeps this mean without rounding. Rounding errors would look like differences between the parts.
template <int N, class Weights>
void merge(std::type_identity_t<std::span<const Gaussian<N>>> parts, const Weights& weights,
           std::span<Gaussian<N>> merged, bool exact = false) {
  constexpr int at_once = 4;
  Eigen::Index j = 0;
  for (; j + at_once <= weights.cols(); j += at_once)
    merge_some<at_once, N>(parts, weights, j, merged.data() + j, exact);
  for (; j < weights.cols(); ++j) merge_some<1, N>(parts, weights, j, merged.data() + j, exact);
}

/// Step 4: mu_j = Lambda_j c_j / c (11.6.6-15), c = sum_j Lambda_j c_j (11.6.6-16). This is Bayes' rule in the log
/// domain: posterior_j is proportional to prior_j exp(log_likelihood_j). Returns log c. The largest term is factored
/// out first; so 0/0 by underflow is impossible. Requires at least one possible mode.
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

/// The filter as published in Salvi et al. (2025), arXiv 2505.00200, eq. 12-18, for comparison with the paper. Here are
/// the differences from the IMM.
namespace salvi2025 {

/// The modes' probabilities from log L_j = log N(C xhat_j - z; 0, S_j). As published in [S25, eq. 16], the residual is
/// that after the update.
template <int N, int NY, class Sensor, class Y>
void weigh_by_posterior(const Sensor& sensor, const Y& z, FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < state.modes.size(); ++j) {
    small::multiply(step.residual, sensor.C, state.modes[j].mean);
    step.residual -= z;
    step.log_likelihood(static_cast<Eigen::Index>(j)) = step.kalman[j].log_normal(step.residual);
  }
  bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
}

}  // namespace salvi2025

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
  state.modes[0].known = model.exact;
  for (std::size_t j = 1; j < state.modes.size(); ++j) state.modes[j] = state.modes[0];
  state.mode_probability = model.initial_probability;
  floor_probabilities(state.mode_probability);
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
    // Weights w(k-1)_i T_ij of [S25, eq. 12-13]. Their sum is below one, so mixed states shrink towards zero.
    step.mixing.noalias() = state.mode_probability.asDiagonal() * model.transition.matrix();
  } else {
    mixing_weights(transition_of_step(model, state, u, step), state.mode_probability, step.predicted_probability,
                   step.mixing);
  }
  const auto known = [&](const Gaussian<N>& mode) { return mode.known && mode.mean == state.modes.front().mean; };
  if (std::all_of(state.modes.begin(), state.modes.end(), known))
    step.mixed = state.modes;
  else
    merge<N>(state.modes, step.mixing, step.mixed, model.exact);
  return step.mixed;
}

/// Computes everything before the measurement: each mode's prediction and S, and the predicted probabilities.
template <int N, int NY, class U>
void predict(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u, FilterStep<N, NY>& step) {
  const std::vector<Gaussian<N>>& from = mix(model, state, u, step);
  double noise_factor = 1.0;  // evaluated at the combined estimate, like a logit
  if (!model.noise_factor.empty()) {
    combine_means(state, step.difference);
    noise_factor = model.noise_factor.at(step.difference, u);
  }
  for (std::size_t j = 0; j < model.modes.size(); ++j) {
    step.kalman[j].predict(from[j], model, model.modes[j], u, noise_factor);
    step.kalman[j].expect(model);
  }
}

/// Steps 3 and 4 without a measurement: the prediction becomes the estimate.
template <int N, int NY>
void skip_measurement(FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < state.modes.size(); ++j) state.modes[j] = step.kalman[j].predicted;
  state.mode_probability = step.predicted_probability;
  floor_probabilities(state.mode_probability);
}

/// Steps 3 and 4 with a measurement `y` of `sensor`: the model, or its part for the available signals. Log Lambda_j =
/// log N(y - C x_j; 0, S_j) (11.6.6-13) is that of the available signals.
template <int N, int NY, class Sensor, class Y>
double take_in(const FilterModel<N, NY>& model, const Sensor& sensor, const Y& y, FilterStep<N, NY>& step,
               FilterState<N>& state) {
  const double excess = 0.5 * log_two_pi * static_cast<double>(step.partial.missing);
  for (std::size_t h = 0; h < step.kalman.size(); ++h) {
    step.kalman[h].observe(sensor, y);
    step.kalman[h].correct(sensor, y, state.modes[h]);
    step.log_likelihood(static_cast<Eigen::Index>(h)) = step.kalman[h].log_density + excess;
  }
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
