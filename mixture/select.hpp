#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mixture/em.hpp"
#include "mixture/features.hpp"
#include "mixture/window_responsibilities.hpp"
#include "modebank/mixture/candidate.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// More points are told apart no better: neighbouring windows share all samples but one.
inline constexpr Eigen::Index most_compared = 100'000;

/// What selection must know of the points beside their values.
struct SampleDesign {
  double effective_samples = 0.0;  ///< independent samples they are worth; 0: all are independent
  /// N, the run each point is from: runs are left out as a whole. Empty: unknown, so there are no held-out scores.
  std::vector<Eigen::Index> runs;
};

/// The chosen mixture and the table it was chosen from.
struct Selection {
  GaussianMixture mixture;  ///< physical units
  std::vector<Candidate> candidates;
  Eigen::Index compared = 0;  ///< points that candidates were compared on, whose numbers they have; 0: all
};

/// Of the numbers of components that are tried.
std::ptrdiff_t most_components(const SelectionOptions& options);

/// Fits every candidate (in parallel over candidates and restarts, seeds split by both) and keeps the best by the
/// criterion (the smaller on a tie). The table is sorted by components, each once. `start`: where the first restart of
/// the candidate of its size begins, in physical units; may be null. Of more than 100,000 points the candidates are
/// fitted to some 50,000 drawn by the seed, and the chosen one then to all of them from there. Throws DataError when
/// every candidate asks for more components than there are distinct points, or none can be scored (held-out: fewer than
/// two runs); std::invalid_argument for no candidate or one below 1.
Selection select(const PointSet& points, const SampleDesign& design, const SelectionOptions& options,
                 std::uint64_t seed, const GaussianMixture* start = nullptr);

/// A selection, and the windows' memberships.
struct MixtureResult {
  GaussianMixture mixture;                 ///< physical units
  std::vector<std::string> feature_names;  ///< F
  /// F x M, NaN where a window has none; empty: the features begin with the parameters of the windows themselves.
  Eigen::MatrixXd features;
  Eigen::VectorXi labels;      ///< M, -1: neither clustered nor assigned, or noise
  Eigen::Index clustered = 0;  ///< windows that the mixture is fitted to; 0: not known (older archives)
  WindowResponsibilities responsibilities;
  std::vector<Candidate> candidates;
  Eigen::Index compared = 0;  ///< windows that candidates were compared on; 0: all that are clustered
};

/// Overlapping windows share samples: N_eff = min(N, sum over runs with a clustered window of max(1, M_run step / L)).
double effective_samples(const FeatureCloud& cloud, Eigen::Index length, Eigen::Index step);

/// select() for the cloud of windows. Those of `assigned` (assigned_features) take no part, but get responsibilities
/// and labels from what was found.
MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed, const GaussianMixture* start = nullptr,
                             const FeatureCloud& assigned = {});

/// Merges the closest components until at most `most` are left: by moments, the pair of least merge_loss first
/// (reduction.hpp). Responsibilities add up, labels follow the merges; the table of candidates stays. Throws
/// std::invalid_argument for `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
