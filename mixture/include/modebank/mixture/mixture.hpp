#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "modebank/base/matrix.hpp"
#include "modebank/mixture/candidate.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank::mixture {

/// N points of F features to be clustered, and what is known of them.
struct Points {
  Matrix values;                     ///< F x N, finite, one point per column, as ident::Windows::theta has them
  std::vector<double> weights;       ///< N, nonnegative; empty: all one
  Matrix errors;                     ///< F*F x N, each column the covariance of that point's error; empty: no errors
  std::vector<std::ptrdiff_t> runs;  ///< N, the run each is from, which is left out as a whole; may be empty
  double effective_samples = 0.0;    ///< independent samples they are worth; 0: all are independent. Windows that
                                     ///< overlap share samples: N step / length
  std::vector<double> typical_error = {};  ///< F, standard deviation of a typical point's error; empty or 0: unknown
};

/// Weighted sum of K Gaussians over F features, in the points' units, and of a uniform component where there is one.
struct Mixture {
  std::vector<double> weights;      ///< K, decreasing; they sum to 1 - noise_weight
  Matrix means;                     ///< F x K
  std::vector<Matrix> covariances;  ///< K of F x F
  double noise_weight = 0.0;        ///< of the uniform component
  std::vector<double> noise_lower;  ///< F, corner of its box; empty: there is none
  std::vector<double> noise_upper;  ///< F, the opposite corner
};

/// The chosen mixture and what it was chosen from.
struct Clusters {
  Mixture mixture;                    ///< of the selected candidate
  std::vector<Candidate> candidates;  ///< by their number of components, each once
  Matrix responsibilities;            ///< K x N, posterior probability of each component at each point
};

/// Fits every candidate number of components, on all cores, and keeps the best by the criterion: the same numbers for
/// any number of threads. Throws std::invalid_argument for an option out of range and for sizes
/// or numbers that cannot be, DataError (modebank/base/error.hpp) when no candidate can be fitted to these points.
Clusters select(const Points& points, const SelectionOptions& options = {}, std::uint64_t seed = 1);

/// Posterior probabilities of the components at other points (F x N), K x N; columns sum to one, or to one minus the
/// probability of noise. Throws std::invalid_argument for sizes that do not fit and a covariance that is none.
Matrix responsibilities(const Mixture& mixture, const Matrix& points);

/// Log density at other points (F x N), N [nats]. Throws as responsibilities does.
std::vector<double> log_density(const Mixture& mixture, const Matrix& points);

}  // namespace modebank::mixture
