#pragma once

#include <cstddef>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank {

/// Shape of the components' covariances.
enum class CovarianceType { full, diagonal };

template <>
struct EnumNames<CovarianceType> {
  static constexpr Names<2> values{"full", "diagonal"};
};

/// Expectation-maximisation of a Gaussian mixture (Dempster, Laird & Rubin 1977), in the log domain. Restarts begin at
/// points drawn as centres.
struct EmOptions {
  CovarianceType covariance = CovarianceType::full;  ///< of the components
  int restarts = 5;                                  ///< independent, >= 1
  /// Split-and-merge moves that each restart tries to leave its optimum (Ueda et al. 2000). 0: none, and restarts are
  /// not crossed.
  int split_merge = 5;
  double tolerance = 1e-7;    ///< stop when the mean log-likelihood per unit weight gains less; negative: never
  int max_iterations = 1000;  ///< M steps, >= 0
  /// Components are kept wider than this share of the variance of a point's error (the median window's), per feature;
  /// where errors are not known, of the data's variance (without far outliers). >= 1e-10
  double covariance_floor = 1e-6;
  bool noise_component = false;  ///< adds a uniform component over the points' bounding box
};

/// What chooses the number of components: information criteria, or the log density of runs left out. bic_naive is BIC
/// as if all points were independent.
enum class Criterion { bic, icl, heldout, bic_naive };

template <>
struct EnumNames<Criterion> {
  static constexpr Names<4> values{"bic", "icl", "heldout", "bic_naive"};
};

/// How the number of components is chosen, and each candidate fitted. Candidates get a held-out score, which takes
/// several more fits each, for at most 20,000 points of known runs, or where it is the criterion. Defaults are the
/// recommended method.
struct SelectionOptions {
  /// Candidate numbers of components, each at least 1.
  std::vector<std::ptrdiff_t> components{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  Criterion criterion = Criterion::bic;  ///< what chooses
  EmOptions em;                          ///< how each candidate is fitted
};

/// Numbers of a window that are clustered: its parameters; besides them the logarithms of its noise variances; or both
/// of a one-lag fit of the same window. automatic: parameters_and_noise up to most_features numbers; beyond, one_lag
/// where the model has lags, and of that the most_features numbers that vary most beyond their errors.
///
/// Clouds of one-lag fits find the modes best, whatever lags the motion has. In 40 clouds of ten known systems, fitted
/// with four and eight lags (12 to 64 coefficients), their adjusted Rand index is 0.82 in the mean; all coefficients
/// reach 0.41, with full and with diagonal covariances (docs/results/mixture.md).
enum class FeatureSet { automatic, parameters, parameters_and_noise, one_lag };

template <>
struct EnumNames<FeatureSet> {
  static constexpr Names<4> values{"auto", "parameters", "parameters+noise", "one_lag"};
};

/// A component with a full covariance has 90 numbers of twelve features; of 25 coefficients it has 350, more than a
/// few hundred independent windows determine.
inline constexpr std::ptrdiff_t most_features = 12;

/// Which windows are clustered. automatic: those whose data determine all parameters; all where that is less than two
/// windows' worth of data per feature (and a prior gives the others a theta), and with error_aware. Others are assigned
/// to the components afterwards, as far as their data tell (with a prior).
enum class WindowChoice { automatic, full_rank, all };

template <>
struct EnumNames<WindowChoice> {
  static constexpr Names<3> values{"automatic", "full_rank", "all"};
};

/// What becomes of windows that straddle a switch of mode: they follow no single model and are a population of their
/// own, which would claim a component. `leave_out` takes those out of the cloud whose residuals show it; `keep`
/// clusters them like the others.
enum class StraddlingWindows { leave_out, keep };

template <>
struct EnumNames<StraddlingWindows> {
  static constexpr Names<2> values{"leave_out", "keep"};
};

/// Which cloud of windows is clustered, and how.
struct ClusterOptions {
  SelectionOptions selection;                                   ///< of the mixture
  FeatureSet features = FeatureSet::automatic;                  ///< what of a window is clustered
  WindowChoice windows = WindowChoice::automatic;               ///< which windows are
  StraddlingWindows straddling = StraddlingWindows::leave_out;  ///< what becomes of those that hold a switch
  bool error_aware = false;  ///< components describe the windows without their errors (Bovy, Hogg & Roweis 2011)
};

}  // namespace modebank
