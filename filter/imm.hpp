#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/bounds.hpp"
#include "filter/transition_matrix.hpp"

/// The probabilities of the interacting multiple model filter, Blom & Bar-Shalom (1988), "The interacting multiple
/// model algorithm for systems with Markovian switching coefficients", IEEE Trans. Automatic Control 33(8).
namespace modebank {

/// Column j holds what each mode i contributes to the start of mode j: mu_{i|j}. Never to be confused with a
/// TransitionMatrix, whose rows sum to one.
struct MixingWeights {
  Eigen::MatrixXd matrix;  ///< K x K
};

/// c_j = sum_i T_ij mu_i and mu_{i|j} = T_ij mu_i / c_j. An impossible mode keeps its own state.
inline void mixing_weights(const TransitionMatrix& transition, const Eigen::VectorXd& mu, Eigen::VectorXd& c,
                           MixingWeights& weights) {
  const Eigen::MatrixXd& T = transition.matrix();
  for (Eigen::Index j = 0; j < mu.size(); ++j) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < mu.size(); ++i) sum += weights.matrix(i, j) = T(i, j) * mu(i);
    c(j) = sum;
    if (sum < impossible_probability)
      weights.matrix.col(j) = Eigen::VectorXd::Unit(mu.size(), j);
    else
      weights.matrix.col(j) *= 1.0 / sum;
  }
}

/// Bayes' rule in the log domain: posterior_j proportional to prior_j exp(log_likelihood_j). Returns
/// log sum_j prior_j exp(log_likelihood_j). The largest term is taken out first, so nothing underflows to 0/0.
/// Requires at least one possible mode.
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
  return largest + std::log(sum);
}

inline void floor_probabilities(Eigen::VectorXd& mu) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < mu.size(); ++j) sum += mu(j) = std::max(mu(j), mode_probability_floor);
  mu *= 1.0 / sum;
}

}  // namespace modebank
