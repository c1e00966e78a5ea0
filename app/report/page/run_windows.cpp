#include <algorithm>
#include <map>

#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/window_text.hpp"
#include "ident/base/distributions.hpp"
#include "io/archive/bank/units.hpp"
#include "mixture/features.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// largest number of drawn windows; more points would hide each other, so only every second, third, ... window is drawn
constexpr Index most_windows = 100'000;

/// Names on the page: labels for parameters, words for noise, a note for features of one lag.
std::vector<std::string> with_labels(std::vector<std::string> features, const Archive& archive) {
  const std::string noise = "log_noise_variance_";
  for (std::string& feature : features)
    if (feature.starts_with(noise)) feature = "log noise variance of " + feature.substr(noise.size());
  features = feature_labels(archive, std::move(features));
  for (std::size_t i = 0; i < archive.windows->model_parameters.size(); ++i)
    features[i] = parameter_words(features[i], archive.windows->model_parameters[i].unit);
  if (!features_origin(archive).empty())
    for (std::string& feature : features) feature += " (one-lag fit)";
  return features;
}

/// Axes of the cloud: the parameters, and the logarithm of the noise variance.
json axes_of(const std::vector<std::string>& names, const Unit& units) {
  json axes = json::array();
  for (std::size_t i = 0; i < names.size(); ++i)
    axes.push_back({{"name", names[i]}, {"unit", i < units.size() && units[i] != "1" ? units[i] : ""}});
  return axes;
}

/// The axes at first: A, B1, B2 as in the paper. With several lags, the first lag of each.
std::vector<Index> default_axes(const WindowFits& fits, bool of_parameters, Index axes) {
  const Index inputs = fits.structure.dimension();
  std::vector<Index> chosen{0, 1, 2};
  if (of_parameters && fits.model_parameters.empty() && fits.structure.inputs >= 2) chosen = {0, inputs, inputs + 1};
  chosen.resize(static_cast<std::size_t>(std::min<Index>(axes, 3)));
  return chosen;
}

json rows_of_matrix(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (Index i = 0; i < matrix.rows(); ++i)
    rows.push_back(std::vector<double>(matrix.row(i).begin(), matrix.row(i).end()));
  return rows;
}

/// The components of the mixture in the coordinates of the cloud, for ellipses.
json components_of(const Archive& archive) {
  const MixtureResult& result = *archive.mixture;
  json components = json::array();
  for (Index k = 0; k < result.mixture.components(); ++k) {
    const Eigen::VectorXd mean = result.mixture.means.col(k);
    components.push_back({{"weight", number(result.mixture.weights(k))},
                          {"mean", std::vector<double>(mean.begin(), mean.end())},
                          {"covariance", rows_of_matrix(result.mixture.covariances[static_cast<std::size_t>(k)])}});
  }
  return {{"features", with_labels(result.feature_names, archive)}, {"list", components}};
}

/// The modes of the bank in the coordinates of the cloud. Linear models have their covariance over the windows.
json modes_of(const Bank& bank) {
  json modes = json::array();
  for (const Mode& mode : bank.modes) {
    const bool linear = bank.motion_parameters.empty();
    const Eigen::VectorXd theta = linear ? pack(bank.structure, mode.model) : mode.motion_theta;
    modes.push_back(
        {{"mean", std::vector<double>(theta.begin(), theta.end())},
         {"covariance",
          linear && mode.parameter_covariance.size() > 0 ? rows_of_matrix(mode.parameter_covariance) : json()}});
  }
  return modes;
}

json labels_of(PageArrays& arrays, const Eigen::VectorXi& labels, const std::vector<Index>& drawn) {
  const Eigen::VectorXi chosen = labels(drawn);
  return arrays.add(std::vector<std::int32_t>(chosen.begin(), chosen.end()));
}

int mode_of(const Window& window, Eigen::Index length, const Eigen::MatrixXd& probability) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(probability.rows());
  for (Eigen::Index k = window.start + 1; k <= window.start + length && k < probability.cols(); ++k)
    if (!probability.col(k).array().isNaN().any()) sum += probability.col(k);
  Eigen::Index best = -1;
  return sum.size() > 0 && sum.maxCoeff(&best) > 0.0 ? static_cast<int>(best) : -1;
}

}  // namespace

Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const FilterEvaluation& evaluation) {
  std::map<Eigen::Index, std::vector<std::size_t>> of_runs;  // in this order, each run is read only once
  for (std::size_t i = 0; i < windows.size(); ++i) of_runs[windows[i].run].push_back(i);
  Eigen::VectorXi modes(static_cast<Eigen::Index>(windows.size()));
  for (const auto& [run, positions] : of_runs)
    evaluation.with_run(static_cast<std::size_t>(run), {"mode_probability"},
                        [&, &own = positions](const RunEvaluation& said) {
                          for (const std::size_t i : own)
                            modes(static_cast<Eigen::Index>(i)) = mode_of(windows[i], length, said.mode_probability);
                        });
  return modes;
}

namespace {

json modes_of_windows(PageArrays& arrays, const WindowFits& fits, const FilterEvaluation& evaluation,
                      const std::vector<Index>& drawn) {
  std::vector<Window> windows;
  for (const Index i : drawn) windows.push_back(fits.windows[static_cast<std::size_t>(i)]);
  const Eigen::VectorXi modes = window_modes(windows, fits.length, evaluation);
  return arrays.add(std::vector<std::int32_t>(modes.begin(), modes.end()));
}

/// The windows that are drawn, each with the index of its point in the cloud.
struct Drawn {
  Index step = 1;
  std::vector<Index> points, windows;
};

Drawn choose(const FeatureCloud& cloud) {
  const Index points = cloud.points.cols();
  Drawn drawn{std::max<Index>(1, (points + most_windows - 1) / most_windows), {}, {}};
  for (Index i = 0; i < points; i += drawn.step) {
    drawn.points.push_back(i);
    drawn.windows.push_back(cloud.windows[static_cast<std::size_t>(i)]);
  }
  return drawn;
}

/// Points of all windows for the case that the clustered features are not the windows' own parameters.
FeatureCloud cloud_of(const Archive& archive) {
  FeatureCloud cloud =
      make_features(*archive.windows, FeatureSet::parameters_and_noise, WindowChoice::all, archive.recording->states);
  if (!archive.mixture || archive.mixture->features.size() == 0) return cloud;
  cloud.names = archive.mixture->feature_names;
  cloud.windows.clear();
  for (Index i = 0; i < archive.mixture->features.cols(); ++i)
    if (archive.mixture->features.col(i).allFinite()) cloud.windows.push_back(i);
  cloud.points = archive.mixture->features(Eigen::all, cloud.windows);
  return cloud;
}

}  // namespace

nlohmann::json windows_section(const Archive& archive, PageArrays& arrays) {
  if (!archive.windows || !archive.recording || archive.windows->count() == 0) return nullptr;
  const WindowFits& fits = *archive.windows;
  const FeatureCloud cloud = cloud_of(archive);
  const bool of_parameters = !archive.mixture || archive.mixture->features.size() == 0;
  const Drawn drawn = choose(cloud);
  json values = json::array();
  for (Index i = 0; i < cloud.points.rows(); ++i) {
    const Eigen::VectorXd row = cloud.points(i, drawn.points).transpose();
    values.push_back(arrays.add(row));
  }
  json section = {
      {"count", count(fits.count())},
      {"step", drawn.step},
      {"length", fits.length},
      {"model", fits.model},
      {"parameters", of_parameters ? fits.parameter_count() : 0},
      {"axes", axes_of(with_labels(cloud.names, archive), feature_units(cloud.names, fits, Units(*archive.recording)))},
      {"default_axes", default_axes(fits, of_parameters, cloud.points.rows())},
      {"values", values},
      {"refined", archive.unrefined.has_value()},
      {"noise", sensor_noise_words(archive)},
      {"level", drawn_level},
      {"limit2", chi_square_quantile(drawn_level, 2.0)}};
  if (archive.mixture) {
    section["label"] = labels_of(arrays, archive.mixture->labels, drawn.windows);
    section["components"] = components_of(archive);
  }
  if (archive.bank) section["bank"] = modes_of(*archive.bank);
  if (const FilterEvaluation* evaluation = evaluation_of(archive, "bank"))
    section["mode"] = modes_of_windows(arrays, fits, *evaluation, drawn.windows);
  return section;
}

}  // namespace modebank::app::report
