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

/// Expectation-maximisation of a Gaussian mixture (Dempster, Laird & Rubin 1977), in the log domain. Each restart
/// begins with randomly drawn points as centres.
struct EmOptions {
  CovarianceType covariance = CovarianceType::full;  ///< shape of all components
  int restarts = 5;                                  ///< number of independent random starts, >= 1

  /// Number of split-and-merge moves that each restart tries from its optimum (Ueda et al. 2000). With 0 there are no
  /// moves, and restarts are not crossed with each other.
  int split_merge = 5;
  double tolerance = 1e-7;    ///< stopping tolerance: gain of the mean log-likelihood per unit weight; a negative value
                              ///< never stops
  int max_iterations = 1000;  ///< largest number of M steps, >= 0

  /// Smallest variance of a component in any feature, >= 1e-10. It is a share of the median window's error variance. If
  /// errors are unknown, it is a share of the data's variance without far outliers
  double covariance_floor = 1e-6;
  bool noise_component = false;  ///< whether to add a uniform component over the points' bounding box
};

/// How candidates are fitted; BIC chooses the number of components. Defaults are the recommended method.
struct SelectionOptions {
  /// Candidate numbers of components, each at least 1.
  std::vector<std::ptrdiff_t> components{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  EmOptions em;  ///< how each candidate is fitted
};

/// Which numbers of a window are clustered. `parameters`: its parameters. `parameters_and_noise`: also the logarithms
/// of its noise variances. `one_lag`: the same numbers, but from a one-lag fit of the same window. `automatic`:
/// parameters_and_noise up to most_features numbers. For more numbers, only the most_features numbers that vary most
/// relative to their errors are clustered; they come from one_lag if the model has lags.
///
/// Clouds of one-lag fits separate the modes best, for any number of lags in the motion. The mean adjusted Rand index
/// is 0.82 over 40 clouds of ten known systems, fitted with four and eight lags (12 to 64 coefficients). If all
/// coefficients are clustered, the index is 0.41, for full and for diagonal covariances (docs/results/simulated.md).
enum class FeatureSet { automatic, parameters, parameters_and_noise, one_lag };

template <>
struct EnumNames<FeatureSet> {
  static constexpr Names<4> values{"auto", "parameters", "parameters+noise", "one_lag"};
};

/// A full-covariance component has 90 free numbers in twelve features. In 25 features it has 350, which is more than a
/// few hundred independent windows determine.
inline constexpr std::ptrdiff_t most_features = 12;

/// Which windows are clustered. `automatic` means the windows whose data determine all parameters. In two cases it
/// means all windows. The first case is error_aware. In the second case, these windows hold less data than two windows
/// per feature, and a prior gives all other windows a theta. With a prior, windows that are not clustered are assigned
/// to the components afterwards, as far as their data allow.
enum class WindowChoice { automatic, full_rank, all };

template <>
struct EnumNames<WindowChoice> {
  static constexpr Names<3> values{"automatic", "full_rank", "all"};
};

/// Treatment of windows that contain a switch of mode. Such windows follow no single model and would form a component
/// of their own. `leave_out` removes those that the residuals reveal. `keep` clusters them like all other windows.
enum class WindowsOverSwitch { leave_out, keep };

template <>
struct EnumNames<WindowsOverSwitch> {
  static constexpr Names<2> values{"leave_out", "keep"};
};

/// How windows are clustered: which windows, in which features, and by which options.
struct ClusterOptions {
  SelectionOptions selection;                                    ///< how the mixture is chosen
  FeatureSet features = FeatureSet::automatic;                   ///< numbers of a window that are clustered
  WindowChoice windows = WindowChoice::automatic;                ///< windows that are clustered
  WindowsOverSwitch over_switch = WindowsOverSwitch::leave_out;  ///< treatment of windows that contain a switch
  bool error_aware = false;  ///< components describe the windows without their errors (Bovy, Hogg & Roweis 2011)
};

}  // namespace modebank
