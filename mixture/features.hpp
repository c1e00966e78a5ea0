#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/model/local_model.hpp"
#include "mixture/point_set.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// The cloud that is clustered: one point per clustered window.
struct FeatureCloud {
  std::vector<std::string> names;     ///< F: parameter names, then "log_noise_variance_<state>" when noise is included
  Eigen::MatrixXd points;             ///< F x N, physical units
  Eigen::MatrixXd covariances;        ///< F*F x N, of the points' errors; empty unless asked for
  Eigen::VectorXd typical_error;      ///< F, median standard deviation of the windows' errors; 0: unknown
  std::vector<Eigen::Index> windows;  ///< N, which window each point is
  std::vector<Eigen::Index> runs;     ///< N, run of that window

  PointSet point_set() const { return PointSet(points, detail::no_weights, covariances, typical_error); }
};

/// Whether the cloud carries the windows' own covariances (error-aware clustering).
enum class WindowErrors { ignore, include };

/// Failed fits and non-finite windows are left out. With errors, points are what the windows' data alone say: a prior
/// is taken off again (otherwise clustering would count it once per window), as far as data determine a direction by 5
/// % at least. A point's covariance is then that of theta, and 2 / (L - rank / n) for the logarithm of a noise variance
/// (delta method: an estimate of sigma^2 on nu degrees of freedom has variance 2 sigma^4 / nu under Gaussian noise),
/// uncorrelated with theta; windows whose covariance is not finite (rank deficient without a prior: their theta is no
/// measurement) are left out.
FeatureCloud make_features(const WindowFits& fits, FeatureSet features, WindowChoice choice,
                           const std::vector<Channel>& states, StraddlingWindows straddling = StraddlingWindows::keep,
                           WindowErrors errors = WindowErrors::ignore);
/// The same as the options say; with FeatureSet::automatic the cloud has most_features features at most.
FeatureCloud make_features(const WindowFits& fits, const std::vector<Channel>& states, const ClusterOptions& options);

/// Whether one-lag fits of the windows are clustered in place of `fits`.
bool clusters_one_lag(const WindowFits& fits, FeatureSet features);

/// The cloud in the features of these names alone, in their order. Throws std::invalid_argument for one that it lacks.
FeatureCloud in_features(FeatureCloud cloud, const std::vector<std::string>& names);

/// Names of the `most` features that vary most beyond their errors, in the cloud's order: by the variance of the points
/// between their 5 % and 95 % quantiles over the typical error's. Features of unknown error come last.
std::vector<std::string> most_varied(const FeatureCloud& cloud, Eigen::Index most);

/// The windows that are not clustered because their data do not determine all parameters, but belong to a component as
/// far as data say: with their errors, which are large in the other directions. Empty without a prior (their theta is
/// then no estimate) and where all windows are clustered. Of these the mixture says how probable each component is.
/// `names`: the features of the cloud that is clustered; empty: all.
FeatureCloud assigned_features(const WindowFits& fits, const std::vector<Channel>& states,
                               const ClusterOptions& options, const std::vector<std::string>& names = {});

}  // namespace modebank
