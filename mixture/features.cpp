#include "mixture/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "mixture/window_error.hpp"
#include "mixture/window_over_switch.hpp"

namespace modebank {

using Eigen::Index;

namespace {

bool failed(const WindowFits& fits, Index window) { return fits.status(window) == static_cast<int>(FitStatus::failed); }

bool full_rank(const WindowFits& fits, Index window) { return fits.rank(window) == fits.parameter_count(); }

/// Whether the full-rank windows are worth at least two independent windows per feature. With fewer windows, the data
/// would not determine a component.
bool enough_of_full_rank(const WindowFits& fits, Index features) {
  Index count = 0;
  for (Index window = 0; window < fits.count(); ++window)
    if (!failed(fits, window) && full_rank(fits, window)) ++count;
  return count * fits.step >= 2 * features * fits.length;
}

/// The windows that WindowChoice::automatic selects for these fits.
WindowChoice resolved(const WindowFits& fits, WindowChoice choice, WindowErrors errors, Index features) {
  if (choice != WindowChoice::automatic) return choice;
  if (errors == WindowErrors::include) return WindowChoice::all;
  const bool others_have_theta = fits.prior_sd.size() > 0;
  return !others_have_theta || enough_of_full_rank(fits, features) ? WindowChoice::full_rank : WindowChoice::all;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Number of features that are clustered.
Index features_kept(FeatureSet features, Index all) {
  return features == FeatureSet::automatic ? std::min<Index>(all, most_features) : all;
}

/// Median standard deviation of the clustered windows' errors; 0 if the errors are unknown.
Eigen::VectorXd typical_error(const WindowFits& fits, const std::vector<Index>& windows, Index features) {
  const Index p = fits.parameter_count();
  Eigen::VectorXd result = Eigen::VectorXd::Zero(features);
  if (fits.covariance.cols() != fits.count()) return result;
  for (Index f = 0; f < features; ++f) {
    std::vector<double> deviations;
    for (const Index window : windows) {
      const double variance = f < p ? fits.covariance(f * (p + 1), window) : log_variance_error(fits, window);
      if (std::isfinite(variance) && variance > 0.0) deviations.push_back(std::sqrt(variance));
    }
    result(f) = median_of(std::move(deviations));
  }
  return result;
}

/// Collects the points of a cloud, window by window, as the options require.
class CloudBuilder {
 public:
  CloudBuilder(const WindowFits& fits, FeatureSet features, const std::vector<Channel>& states, WindowErrors errors)
      : fits_(fits), with_errors_(errors == WindowErrors::include) {
    const Index p = fits.parameter_count(), n = fits.structure.states;
    if (static_cast<Index>(states.size()) != n)
      throw std::invalid_argument(
          fmt::format("{} states have {} names; expected one name per state", n, states.size()));
    noises_ = features == FeatureSet::parameters ? 0 : n;
    cloud_.names = fits.parameter_names();
    for (Index i = 0; i < noises_; ++i)
      cloud_.names.push_back("log_noise_variance_" + states[static_cast<std::size_t>(i)].name);
    const Index F = p + noises_;
    cloud_.points.resize(F, fits.count());
    cloud_.covariances.resize(F * F, with_errors_ ? fits.count() : 0);
    point_.resize(F);
    error_ = Eigen::MatrixXd::Zero(F, F);
  }

  Index features() const { return point_.size(); }

  /// Adds a window. Skips the window if its point or error is not finite.
  void add(Index window) {
    const Index p = fits_.parameter_count();
    theta_ = fits_.parameters.col(window);
    if (with_errors_ && !describe_error(window)) return;
    point_.head(p) = theta_;
    if (noises_ > 0) point_.tail(noises_) = fits_.noise_variance.col(window).array().log();
    if (!point_.allFinite()) return;
    const auto position = static_cast<Index>(cloud_.windows.size());
    cloud_.points.col(position) = point_;
    if (with_errors_) cloud_.covariances.col(position) = error_.reshaped();
    cloud_.windows.push_back(window);
    cloud_.runs.push_back(fits_.windows[static_cast<std::size_t>(window)].run);
  }

  FeatureCloud take() {
    const auto count = static_cast<Index>(cloud_.windows.size());
    cloud_.points.conservativeResize(Eigen::NoChange, count);
    if (with_errors_) cloud_.covariances.conservativeResize(Eigen::NoChange, count);
    cloud_.typical_error = typical_error(fits_, cloud_.windows, features());
    return std::move(cloud_);
  }

 private:
  bool describe_error(Index window) {
    const Index p = fits_.parameter_count();
    covariance_ = Eigen::Map<const Eigen::MatrixXd>(fits_.covariance.col(window).data(), p, p);
    if (!covariance_.allFinite() || !theta_.allFinite()) return false;
    if (fits_.prior_sd.size() > 0) {
      if (!prior_comes_off(fits_, window)) return false;
      take_off_prior(fits_, window, theta_, covariance_);
    }
    error_.topLeftCorner(p, p) = covariance_;
    error_.diagonal().tail(noises_).setConstant(log_variance_error(fits_, window));
    return true;
  }

  const WindowFits& fits_;
  bool with_errors_;
  Index noises_ = 0;
  FeatureCloud cloud_;
  Eigen::VectorXd point_, theta_;
  Eigen::MatrixXd error_, covariance_;
};

/// Variance of the values, clamped to their 5 % and 95 % quantiles. Large sets are thinned.
double central_variance(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& all) {
  constexpr Index enough = 20'000;
  constexpr double tail = 0.05;
  const Index stride = std::max<Index>(1, all.size() / enough);
  std::vector<double> values;
  for (Index i = 0; i < all.size(); i += stride) values.push_back(all(i));
  if (values.size() < 2) return 0.0;
  std::sort(values.begin(), values.end());
  const auto cut = static_cast<std::size_t>(tail * static_cast<double>(values.size() - 1));
  const Eigen::Map<const Eigen::ArrayXd> sorted(values.data(), std::ssize(values));
  const Eigen::ArrayXd drawn_in = sorted.max(values[cut]).min(values[values.size() - 1 - cut]);
  return (drawn_in - drawn_in.mean()).square().mean();
}

std::vector<bool> left_out(const WindowFits& fits, WindowsOverSwitch over_switch) {
  return over_switch != WindowsOverSwitch::keep ? windows_over_switch(fits)
                                                : std::vector<bool>(static_cast<std::size_t>(fits.count()), false);
}

}  // namespace

FeatureCloud make_features(const WindowFits& fits, FeatureSet features, WindowChoice choice,
                           const std::vector<Channel>& states, WindowsOverSwitch over_switch, WindowErrors errors) {
  CloudBuilder builder(fits, features, states, errors);
  const bool all = resolved(fits, choice, errors, features_kept(features, builder.features())) == WindowChoice::all;
  const std::vector<bool> out = left_out(fits, over_switch);
  for (Index window = 0; window < fits.count(); ++window)
    if (!failed(fits, window) && !out[static_cast<std::size_t>(window)] && (all || full_rank(fits, window)))
      builder.add(window);
  return builder.take();
}

FeatureCloud make_features(const WindowFits& fits, const std::vector<Channel>& states, const ClusterOptions& options) {
  FeatureCloud cloud = make_features(fits, options.features, options.windows, states, options.over_switch,
                                     options.error_aware ? WindowErrors::include : WindowErrors::ignore);
  const Index kept = features_kept(options.features, cloud.points.rows());
  if (kept == cloud.points.rows()) return cloud;
  const std::vector<std::string> names = most_varied(cloud, kept);
  return in_features(std::move(cloud), names);
}

bool clusters_one_lag(const WindowFits& fits, FeatureSet features) {
  if (!fits.model_parameters.empty() || !fits.structure.has_several_lags()) return false;
  return features == FeatureSet::one_lag ||
         (features == FeatureSet::automatic && fits.parameter_count() + fits.structure.states > most_features);
}

FeatureCloud in_features(FeatureCloud cloud, const std::vector<std::string>& names) {
  std::vector<Index> rows, entries;
  for (const std::string& name : names) {
    const auto found = std::find(cloud.names.begin(), cloud.names.end(), name);
    if (found == cloud.names.end()) throw std::invalid_argument("the cloud has no feature " + name);
    rows.push_back(found - cloud.names.begin());
  }
  for (const Index column : rows)
    for (const Index row : rows) entries.push_back(row + column * cloud.points.rows());
  if (cloud.covariances.size() > 0) cloud.covariances = cloud.covariances(entries, Eigen::all).eval();
  if (cloud.typical_error.size() > 0) cloud.typical_error = cloud.typical_error(rows).eval();
  cloud.points = cloud.points(rows, Eigen::all).eval();
  cloud.names = names;
  return cloud;
}

std::vector<std::string> most_varied(const FeatureCloud& cloud, Index most) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t f = 0; f < cloud.names.size(); ++f) {
    const double error = cloud.typical_error(static_cast<Index>(f));
    const double ratio =
        error > 0.0 ? std::sqrt(central_variance(cloud.points.row(static_cast<Index>(f)))) / error : 0.0;
    ranked.emplace_back(-ratio, f);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  ranked.resize(std::min(ranked.size(), static_cast<std::size_t>(most)));
  std::vector<std::size_t> kept;
  for (const auto& [ratio, f] : ranked) kept.push_back(f);
  std::sort(kept.begin(), kept.end());
  std::vector<std::string> names;
  for (const std::size_t f : kept) names.push_back(cloud.names[f]);
  return names;
}

FeatureCloud assigned_features(const WindowFits& fits, const std::vector<Channel>& states,
                               const ClusterOptions& options, const std::vector<std::string>& names) {
  CloudBuilder builder(fits, options.features, states, WindowErrors::include);
  const auto taken = [&] {
    FeatureCloud cloud = builder.take();
    return names.empty() ? cloud : in_features(std::move(cloud), names);
  };
  const WindowErrors errors = options.error_aware ? WindowErrors::include : WindowErrors::ignore;
  const Index kept = features_kept(options.features, builder.features());
  if (fits.prior_sd.size() == 0 || resolved(fits, options.windows, errors, kept) == WindowChoice::all) return taken();
  const std::vector<bool> out = left_out(fits, options.over_switch);
  for (Index window = 0; window < fits.count(); ++window)
    if (!failed(fits, window) && !out[static_cast<std::size_t>(window)] && !full_rank(fits, window))
      builder.add(window);
  return taken();
}

}  // namespace modebank
