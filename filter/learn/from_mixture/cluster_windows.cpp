#include "filter/learn/from_mixture/cluster_windows.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/fit_windows.hpp"
#include "mixture/features.hpp"

namespace modebank {
namespace {

bool begin_with(const std::vector<std::string>& names, const std::vector<std::string>& first) {
  return names.size() >= first.size() && std::equal(first.begin(), first.end(), names.begin());
}

/// F x M features of the windows that have features, in the order of `clustered`.
Eigen::MatrixXd features_of_all(const WindowFits& fits, const std::vector<Channel>& states,
                                const FeatureCloud& clustered) {
  const FeatureCloud all =
      in_features(make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::all, states), clustered.names);
  Eigen::MatrixXd features = Eigen::MatrixXd::Constant(all.points.rows(), fits.count(), not_a_number);
  features(Eigen::all, all.windows) = all.points;
  return features;
}

}  // namespace

MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed) {
  std::optional<WindowFits> one_lag;
  if (clusters_one_lag(fits, options.features)) one_lag = fit_one_lag(recording, fits, window);
  const WindowFits& seen = one_lag ? *one_lag : fits;
  const FeatureCloud cloud = make_features(seen, recording.states, options);
  MixtureResult result = select_mixture(seen, cloud, options.selection, seed, nullptr,
                                        assigned_features(seen, recording.states, options, cloud.names));
  if (one_lag || !begin_with(cloud.names, seen.parameter_names()))
    result.features = features_of_all(seen, recording.states, cloud);
  return result;
}

}  // namespace modebank
