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

/// With more points than this, candidates are not separated better, because neighbouring windows share all samples but
/// one.
inline constexpr Eigen::Index most_compared = 100'000;

/// The chosen mixture and the table of candidates.
struct Selection {
  GaussianMixture mixture;  ///< physical units
  std::vector<Candidate> candidates;
  Eigen::Index compared = 0;  ///< number of points on which candidates were compared and their figures were computed; 0
                              ///< means all points
};

/// The largest candidate number of components.
std::ptrdiff_t most_components(const SelectionOptions& options);

/// Fits every candidate and keeps the one with the lowest BIC, on a tie the smaller one. Runs in parallel over
/// candidates and restarts, each with its own seed. The table is sorted by number of components, without duplicates.
/// `start` (physical units, may be null) starts the first restart of the candidate of its size. Above 100,000 points,
/// candidates are fitted to about 50,000 points drawn by the seed. The chosen candidate is then fitted to all points,
/// from that result. `effective_samples`: effective number of independent samples of the points; 0 if all are
/// independent. Throws DataError if every candidate has more components than there are distinct points. Throws
/// std::invalid_argument without candidates or for a candidate below 1.
Selection select(const PointSet& points, double effective_samples, const SelectionOptions& options, std::uint64_t seed,
                 const GaussianMixture* start = nullptr);

/// A selection, and the windows' memberships.
struct MixtureResult {
  GaussianMixture mixture;                 ///< physical units
  std::vector<std::string> feature_names;  ///< F

  /// F x M, NaN for windows without features. Empty if the first features are the windows' own parameters.
  Eigen::MatrixXd features;
  Eigen::VectorXi labels;  ///< M, component of each window; -1 for noise, and for windows that are neither clustered
                           ///< nor assigned
  Eigen::Index clustered = 0;  ///< number of windows to which the mixture is fitted
  WindowResponsibilities responsibilities;
  std::vector<Candidate> candidates;
  Eigen::Index compared = 0;  ///< number of windows on which candidates were compared; 0 means all clustered windows
};

/// N_eff = min(N, sum over runs with a clustered window of max(1, M_run step / L)). Overlapping windows share samples.
double effective_samples(const FeatureCloud& cloud, Eigen::Index length, Eigen::Index step);

/// select() for the cloud of windows. The windows of `assigned` (from assigned_features) do not influence the mixture.
/// They get their responsibilities and labels from the finished mixture.
MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed, const GaussianMixture* start = nullptr,
                             const FeatureCloud& assigned = {});

/// Merges components until at most `most` remain. The pair with the least merge_loss is merged first, and moments are
/// preserved (reduction.hpp). Responsibilities are added and labels updated. The table of candidates does not change.
/// Throws std::invalid_argument for `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
