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

/// Above this number, more points do not separate candidates better: neighbouring windows share all samples but one.
inline constexpr Eigen::Index most_compared = 100'000;

/// Sampling design of the points: independent samples and runs.
struct SampleDesign {
  double effective_samples = 0.0;  ///< independent samples that the points are worth; 0: all are independent
  /// N, run of each point; runs are left out as a whole. Empty: runs are unknown, and no held-out scores are computed.
  std::vector<Eigen::Index> runs;
};

/// The chosen mixture and the table of candidates.
struct Selection {
  GaussianMixture mixture;  ///< physical units
  std::vector<Candidate> candidates;
  Eigen::Index compared = 0;  ///< number of points on which candidates were compared and their figures computed; 0: all
};

/// The largest candidate number of components.
std::ptrdiff_t most_components(const SelectionOptions& options);

/// Fits every candidate and keeps the best by the criterion, the smaller one on a tie. Runs in parallel over candidates
/// and restarts, with seeds split by both. The table is sorted by components, each number once. `start` (physical
/// units, may be null): start of the first restart of the candidate of its size.
/// Above 100,000 points, candidates are fitted to about 50,000 points drawn by the seed. The chosen one is then fitted
/// to all points from there.
/// Throws DataError if every candidate has more components than there are distinct points, or none can be scored
/// (held-out: fewer than two runs). Throws std::invalid_argument for no candidate or one below 1.
Selection select(const PointSet& points, const SampleDesign& design, const SelectionOptions& options,
                 std::uint64_t seed, const GaussianMixture* start = nullptr);

/// A selection, and the windows' memberships.
struct MixtureResult {
  GaussianMixture mixture;                 ///< physical units
  std::vector<std::string> feature_names;  ///< F
  /// F x M, NaN for windows without features. Empty: the features begin with the windows' own parameters.
  Eigen::MatrixXd features;
  Eigen::VectorXi labels;      ///< M, component of each window; -1: noise, or neither clustered nor assigned
  Eigen::Index clustered = 0;  ///< number of windows that the mixture is fitted to; 0: unknown (older archives)
  WindowResponsibilities responsibilities;
  std::vector<Candidate> candidates;
  Eigen::Index compared = 0;  ///< number of windows on which candidates were compared; 0: all clustered windows
};

/// N_eff = min(N, sum over runs with a clustered window of max(1, M_run step / L)). Overlapping windows share samples.
double effective_samples(const FeatureCloud& cloud, Eigen::Index length, Eigen::Index step);

/// select() for the cloud of windows. The windows of `assigned` (assigned_features) do not influence the mixture; they
/// get responsibilities and labels from it.
MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed, const GaussianMixture* start = nullptr,
                             const FeatureCloud& assigned = {});

/// Merges components until at most `most` are left, the pair of least merge_loss first, preserving moments
/// (reduction.hpp). Responsibilities add up and labels follow. The table of candidates does not change. Throws
/// std::invalid_argument for `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
