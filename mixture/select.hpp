#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "mixture/em.hpp"
#include "mixture/features.hpp"
#include "mixture/window_responsibilities.hpp"

namespace modebank {

enum class Criterion { bic, icl, aic, heldout, bic_naive };

template <>
struct EnumNames<Criterion> {
  static constexpr Names<5> values{"bic", "icl", "aic", "heldout", "bic_naive"};
};

/// When candidates get a held-out score, which takes several more fits each: if it is affordable (at most 20,000
/// points) or the criterion; always; or only as the criterion.
enum class HeldoutChoice { automatic, always, never };

template <>
struct EnumNames<HeldoutChoice> {
  static constexpr Names<3> values{"auto", "always", "never"};
};

struct SelectionOptions {
  std::vector<Eigen::Index> components;  ///< candidate numbers of components, each at least 1
  Criterion criterion = Criterion::bic;
  HeldoutChoice heldout = HeldoutChoice::automatic;
  EmOptions em;
  std::optional<GaussianMixture> start;  ///< the first restart of the candidate of its size begins here
  int bootstrap = 0;                     ///< resamples of the runs for standard errors, 0: none
};

enum class CandidateStatus { fitted, too_few_points, failed };

template <>
struct EnumNames<CandidateStatus> {
  static constexpr Names<3> values{"fitted", "too_few_points", "failed"};
};

/// One row of /mixture/candidates. Criteria: lower is better (opposite of mclust), except `heldout`. A candidate with
/// more components than there are distinct points (too_few_points), or whose fit met numbers it cannot handle (failed),
/// has the likelihood minus infinity and the criteria plus infinity.
struct Candidate {
  Eigen::Index components = 0;
  CovarianceType covariance = CovarianceType::full;
  double log_likelihood = 0.0;     ///< unscaled, physical units
  Eigen::Index parameters = 0;     ///< q
  double effective_samples = 0.0;  ///< N_eff
  double bic = 0.0, aic = 0.0, icl = 0.0;
  double heldout = 0.0;  ///< mean log density per point of runs left out; NaN unless asked for
  int iterations = 0;
  bool converged = false;
  int agreeing_restarts = 0;
  bool selected = false;
  double bic_naive = not_a_number;  ///< BIC as if the points were independent: for comparison
  int restarts = 0;
  bool floor_active = false;  ///< whether the covariance floor holds any component: a cluster without extent
  CandidateStatus status = CandidateStatus::fitted;
};

/// What selection must know of the points beside their values.
struct SampleDesign {
  double effective_samples = 0.0;  ///< independent samples they are worth; 0: all are independent
  /// N, the run each point is from: what is left out and resampled together. Empty: unknown, so there are no held-out
  /// scores and no bootstrap.
  std::vector<Eigen::Index> runs;
};

/// Standard errors of the selected mixture, see bootstrap.hpp; empty when not asked for.
struct MixtureErrors {
  Eigen::VectorXd weights;  ///< K
  Eigen::MatrixXd means;    ///< F x K [feature unit]
};

/// The chosen mixture and the table it was chosen from.
struct Selection {
  GaussianMixture mixture;  ///< physical units
  std::vector<Candidate> candidates;
  MixtureErrors standard_error;
};

/// Fits every candidate (in parallel over candidates and restarts, seeds split by both) and keeps the best by the
/// criterion (the smaller on a tie). The table is sorted by components, each once. Throws DataError when every
/// candidate asks for more components than there are distinct points, or none can be scored (held-out: fewer than two
/// runs); std::invalid_argument for no candidate or one below 1.
Selection select(const PointSet& points, const SampleDesign& design, const SelectionOptions& options,
                 std::uint64_t seed);

/// A selection, and the windows' memberships.
struct MixtureResult {
  GaussianMixture mixture;                 ///< physical units
  std::vector<std::string> feature_names;  ///< F
  Eigen::VectorXi labels;                  ///< M, -1: not clustered, or noise
  WindowResponsibilities responsibilities;
  std::vector<Candidate> candidates;
  Eigen::VectorXd weights_standard_error;  ///< K; empty without a bootstrap
  Eigen::MatrixXd means_standard_error;    ///< F x K; empty without a bootstrap
};

/// Overlapping windows share samples: N_eff = min(N, sum over runs with a clustered window of max(1, M_run step / L)).
double effective_samples(const FeatureCloud& cloud, Eigen::Index length, Eigen::Index step);

/// select() for the cloud of windows.
MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed);

/// Merges the closest components until at most `most` are left: by moments, the pair of least merge_loss first
/// (reduction.hpp). Responsibilities add up, labels follow the merges; the table of candidates stays. Throws
/// std::invalid_argument for `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
