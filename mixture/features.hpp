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
  Eigen::MatrixXd points;             ///< F x N, points in physical units
  Eigen::MatrixXd covariances;        ///< F*F x N, covariance of each point's error; empty unless requested
  Eigen::VectorXd typical_error;      ///< F, median standard deviation of the windows' errors; 0 if the errors are
                                      ///< unknown
  std::vector<Eigen::Index> windows;  ///< N, index of each point's window
  std::vector<Eigen::Index> runs;     ///< N, index of the run of each point's window

  PointSet point_set() const { return PointSet(points, detail::no_weights, covariances, typical_error); }
};

/// Whether the cloud has the windows' own covariances as errors (error-aware clustering).
enum class WindowErrors { ignore, include };

/// The cloud of the clustered windows, without failed fits and non-finite windows.
///
/// With errors, a point is the estimate from the window's data alone.
/// - The prior is removed, because clustering would count it once per window. This works in directions where data
///   have at least 5 % of the information.
/// - The point's covariance is that of theta. The logarithm of a noise variance has variance 2 / (L - rank / n),
///   uncorrelated with theta (delta method: an estimate of sigma^2 on nu degrees of freedom has variance 2 sigma^4 / nu
///   under Gaussian noise).
/// - Windows with a non-finite covariance are skipped: they are rank deficient without a prior, so their theta
///   contains no information.
FeatureCloud make_features(const WindowFits& fits, FeatureSet features, WindowChoice choice,
                           const std::vector<Channel>& states, WindowsOverSwitch over_switch = WindowsOverSwitch::keep,
                           WindowErrors errors = WindowErrors::ignore);
/// make_features with the choices of the options. FeatureSet::automatic gives at most most_features features.
FeatureCloud make_features(const WindowFits& fits, const std::vector<Channel>& states, const ClusterOptions& options);

/// Whether one-lag fits of the windows are clustered in place of `fits`.
bool clusters_one_lag(const WindowFits& fits, FeatureSet features);

/// The cloud restricted to the named features, in the order of the names. Throws std::invalid_argument for a name
/// without a feature in the cloud.
FeatureCloud in_features(FeatureCloud cloud, const std::vector<std::string>& names);

/// Names of the `most` features that vary most relative to their errors, in the cloud's order. The measure is the
/// variance of the points between their 5 % and 95 % quantiles, divided by the variance of the typical error. Features
/// of unknown error come last.
std::vector<std::string> most_varied(const FeatureCloud& cloud, Eigen::Index most);

/// Windows that are not clustered but get a membership. Their data do not determine all parameters, so their errors are
/// large in some directions. For each such window the mixture gives the probability of each component. Empty without a
/// prior, because theta then estimates nothing, and if all windows are clustered. `names`: features of the clustered
/// cloud; if empty, all features.
FeatureCloud assigned_features(const WindowFits& fits, const std::vector<Channel>& states,
                               const ClusterOptions& options, const std::vector<std::string>& names = {});

}  // namespace modebank
