#include "mixture/features.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "mixture/straddling.hpp"

namespace modebank {

using Eigen::Index;

namespace {

bool wanted(const WindowFits& fits, WindowChoice choice, Index window) {
  if (fits.status(window) == static_cast<int>(FitStatus::failed)) return false;
  const bool full_rank_only =
      choice == WindowChoice::full_rank || (choice == WindowChoice::automatic && fits.prior_sd.size() == 0);
  return !full_rank_only || fits.rank(window) == fits.parameter_count();
}

}  // namespace

FeatureCloud make_features(const WindowFits& fits, FeatureSet features, WindowChoice choice,
                           const std::vector<Channel>& states, StraddlingWindows straddling, WindowErrors) {
  const Index p = fits.parameter_count(), n = fits.structure.states;
  const bool with_noise = features == FeatureSet::parameters_and_noise;
  if (static_cast<Index>(states.size()) != n)
    throw std::invalid_argument(fmt::format("features of {} states are given {} state names", n, states.size()));
  FeatureCloud cloud;
  cloud.names = fits.parameter_names();
  if (with_noise)
    for (const Channel& state : states) cloud.names.push_back("log_noise_variance_" + state.name);
  Eigen::VectorXd point(p + (with_noise ? n : 0));
  Eigen::MatrixXd points(point.size(), fits.count());
  const std::vector<bool> left_out = straddling != StraddlingWindows::keep
                                         ? straddling_windows(fits)
                                         : std::vector<bool>(static_cast<std::size_t>(fits.count()), false);
  for (Index window = 0; window < fits.count(); ++window) {
    if (!wanted(fits, choice, window) || left_out[static_cast<std::size_t>(window)]) continue;
    point.head(p) = fits.parameters.col(window);
    if (with_noise) point.tail(n) = fits.noise_variance.col(window).array().log();
    if (!point.allFinite()) continue;
    points.col(static_cast<Index>(cloud.windows.size())) = point;
    cloud.windows.push_back(window);
    cloud.runs.push_back(fits.windows[window].run);
  }
  cloud.points = points.leftCols(static_cast<Index>(cloud.windows.size()));
  return cloud;
}

FeatureCloud subset(const FeatureCloud& cloud, const std::vector<Index>& positions) {
  FeatureCloud part;
  part.names = cloud.names;
  part.points = cloud.points(Eigen::all, positions);
  if (cloud.covariances.size() > 0) part.covariances = cloud.covariances(Eigen::all, positions);
  for (const Index i : positions) {
    part.windows.push_back(cloud.windows[static_cast<std::size_t>(i)]);
    part.runs.push_back(cloud.runs[static_cast<std::size_t>(i)]);
  }
  return part;
}

}  // namespace modebank
