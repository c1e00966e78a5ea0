#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "modebank/base/matrix.hpp"
#include "modebank/mixture/candidate.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank::mixture {

/// N points of F features for clustering, with their weights and errors.
struct Points {
  Matrix values;                   ///< F x N, finite, one point per column, the layout of ident::Windows::theta
  std::vector<double> weights;     ///< N, nonnegative; if empty, all weights are one
  Matrix errors;                   ///< F*F x N, each column the covariance of that point's error; empty without errors
  double effective_samples = 0.0;  ///< effective number of independent samples of the points; 0 if all are independent.
                                   ///< For overlapping windows, which share samples, it is N step / length
  std::vector<double> typical_error = {};  ///< F, standard deviation of a typical point's error; empty or 0 if unknown
};

/// Weighted sum of K Gaussians over F features, in the points' units, with an optional uniform component.
struct Mixture {
  std::vector<double> weights;      ///< K weights, decreasing; the sum is 1 - noise_weight
  Matrix means;                     ///< F x K
  std::vector<Matrix> covariances;  ///< K covariances of size F x F
  double noise_weight = 0.0;        ///< weight of the uniform component
  std::vector<double> noise_lower;  ///< F, lower corner of the component's box; empty without a uniform component
  std::vector<double> noise_upper;  ///< F, upper corner of the component's box
};

/// The chosen mixture and the candidates.
struct Clusters {
  Mixture mixture;                    ///< mixture of the selected candidate
  std::vector<Candidate> candidates;  ///< in increasing number of components, without duplicates
  Matrix responsibilities;            ///< K x N, posterior probability of each component at each point
};

/// Fits every candidate number of components on all cores and keeps the one with the lowest BIC. The result is the
/// same for any number of threads. Throws std::invalid_argument for an option out of range, sizes that do not fit or
/// invalid numbers. Throws DataError (modebank/base/error.hpp) if no candidate can be fitted to the points.
Clusters select(const Points& points, const SelectionOptions& options = {}, std::uint64_t seed = 1);

/// Posterior probabilities of the components at other points (F x N), K x N. Columns sum to one, or to one minus the
/// probability of noise. Throws std::invalid_argument for sizes that do not fit and for an invalid covariance.
Matrix responsibilities(const Mixture& mixture, const Matrix& points);

/// Log density at other points (F x N), N values [nats]. Throws the errors of `responsibilities`.
std::vector<double> log_density(const Mixture& mixture, const Matrix& points);

}  // namespace modebank::mixture
