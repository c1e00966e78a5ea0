#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mixture/em.hpp"
#include "mixture/features.hpp"
#include "mixture/window_responsibilities.hpp"

namespace modebank {

enum class Criterion { bic, icl, aic, heldout, bic_naive };

template <>
struct EnumNames<Criterion> {
  static constexpr Names<5> values{"bic", "icl", "aic", "heldout", "bic_naive"};
};

struct SelectionOptions {
  std::vector<Eigen::Index> components;  ///< candidate numbers of components; those above N points are left out
  Criterion criterion = Criterion::bic;
  EmOptions em;
};

/// One row of /mixture/candidates. Criteria: lower is better (opposite of mclust), except `heldout`.
struct Candidate {
  Eigen::Index components = 0;
  CovarianceType covariance = CovarianceType::full;
  double log_likelihood = 0.0;     ///< unscaled, physical units
  Eigen::Index parameters = 0;     ///< q
  double effective_samples = 0.0;  ///< N_eff
  double bic = 0.0, aic = 0.0, icl = 0.0;
  double heldout = 0.0;  ///< mean log density per window of runs left out; NaN unless it is the criterion
  int iterations = 0;
  bool converged = false;
  int agreeing_restarts = 0;
  bool selected = false;
};

/// The chosen mixture, the windows' memberships and the table it was chosen from.
struct MixtureResult {
  GaussianMixture mixture;                 ///< physical units
  std::vector<std::string> feature_names;  ///< F
  Eigen::VectorXi labels;                  ///< M, -1: not clustered, or noise
  WindowResponsibilities responsibilities;
  std::vector<Candidate> candidates;
};

/// Overlapping windows share samples: N_eff = min(N, sum over runs with a clustered window of max(1, M_run step / L)).
double effective_samples(const FeatureCloud& cloud, Eigen::Index length, Eigen::Index step);

/// Fits every candidate (in parallel over candidates and restarts, seeds split by both) and keeps the best by the
/// criterion (the smaller on a tie; rows that are not finite are never chosen). The table is sorted by components, each
/// once. Throws DataError when every candidate asks for more components than there are points, or none can be scored
/// (held-out: fewer than two runs); std::invalid_argument for no candidate or one below 1.
MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed);

}  // namespace modebank
