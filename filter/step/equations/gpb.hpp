#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "filter/step/equations/imm.hpp"

/// Generalised pseudo-Bayesian filters: what they do otherwise than the IMM (imm.hpp). First order (Ackerson & Fu 1970;
/// Bar-Shalom, Li & Kirubarajan 2001, section 11.6.4): all modes start from one common estimate. Second order (Chang &
/// Athans 1978; section 11.6.5): every mode predicts from every mode, and the K^2 estimates are merged after the
/// measurement.
namespace modebank::gpb {

/// First order: the common estimate, once per mode.
template <int N>
void start_from_one(const FilterState<N>& state, bool exact, std::vector<Gaussian<N>>& mixed) {
  merge(state.modes, state.mode_probability, mixed[0], exact);
  for (std::size_t j = 1; j < mixed.size(); ++j) mixed[j] = mixed[0];
}

/// Every mode j from every mode i, of probability T_ij mu_i.
template <int N, int NY, class U>
void predict_pairs(const FilterModel<N, NY>& model, const FilterState<N>& state, const U& u, FilterStep<N, NY>& step) {
  const Eigen::MatrixXd& T = transition_of_step(model, state, u, step);
  mixing_weights(T, state.mode_probability, step.predicted_probability, step.mixing);
  const std::size_t K = model.modes.size();
  const double noise_scale = noise_of_step(model, state, u, step);
  for (std::size_t j = 0; j < K; ++j)
    for (std::size_t i = 0; i < K; ++i) {
      const auto from = static_cast<Eigen::Index>(i), to = static_cast<Eigen::Index>(j);
      step.pair_probability(to * static_cast<Eigen::Index>(K) + from) = T(from, to) * state.mode_probability(from);
      step.kalman[j * K + i].predict(state.modes[i], model, model.modes[j], u, noise_scale);
      step.kalman[j * K + i].expect(model);
    }
}

/// The K estimates that lead to mode j, of a list over pairs.
template <int N>
std::span<const Gaussian<N>> leading_to(const std::vector<Gaussian<N>>& pairs, std::size_t j, std::size_t K) {
  return std::span<const Gaussian<N>>(pairs).subspan(j * K, K);
}

/// What the pairs say together after the measurement: one estimate per mode, and the modes' probabilities. Returns the
/// log predictive density.
template <int N, int NY>
double merge_pairs(const FilterModel<N, NY>& model, FilterStep<N, NY>& step, FilterState<N>& state) {
  const std::size_t K = state.modes.size();
  for (std::size_t j = 0; j < K; ++j) {
    const auto mode = static_cast<Eigen::Index>(j), first = static_cast<Eigen::Index>(j * K);
    const auto prior = step.mixing.matrix.col(mode);
    step.mode_likelihood(mode) =
        bayes(prior, step.log_likelihood.segment(first, static_cast<Eigen::Index>(K)), step.merging);
    merge(leading_to(step.corrected, j, K), step.merging, state.modes[j], model.exact);
  }
  return bayes(step.predicted_probability, step.mode_likelihood, state.mode_probability);
}

/// Where nothing was measured.
template <int N, int NY>
void keep_prediction(const FilterModel<N, NY>& model, FilterStep<N, NY>& step, FilterState<N>& state) {
  const std::size_t K = state.modes.size();
  for (std::size_t h = 0; h < step.kalman.size(); ++h) step.corrected[h] = step.kalman[h].predicted;
  for (std::size_t j = 0; j < K; ++j)
    merge(leading_to(step.corrected, j, K), step.mixing.matrix.col(static_cast<Eigen::Index>(j)), state.modes[j],
          model.exact);
}

}  // namespace modebank::gpb
