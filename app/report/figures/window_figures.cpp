#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/report/figures/confidence_ellipse.hpp"
#include "app/report/figures/palette.hpp"
#include "app/report/figures/run_figures.hpp"
#include "app/report/figures/shown_groups.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/window_text.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app::report {
namespace {

constexpr Index most_points = 6000;  // of local_models: more would only make the file large
constexpr Index ellipse_points = 97;
constexpr double ellipse_level = 0.95;

/// A parameter of A and two of B as in the paper; other parameters where there are none.
std::vector<Index> projection_axes(const std::vector<std::string>& names) {
  std::vector<Index> axes;
  const auto take = [&](const std::string& letter, std::size_t most) {
    for (std::size_t i = 0; i < names.size() && axes.size() < most; ++i) {
      const auto index = static_cast<Index>(i);
      if (names[i].rfind(letter, 0) == 0 && std::find(axes.begin(), axes.end(), index) == axes.end())
        axes.push_back(index);
    }
  };
  take("A", 1);
  take("B", 3);
  take("", 3);
  return axes;
}

/// Windows of these components (-1: of none), every `stride`-th, their parameters at `axes`.
Eigen::MatrixXd points_of(const Archive& archive, const std::vector<Index>& components, Index stride,
                          const std::vector<Index>& axes) {
  std::vector<Index> columns;
  for (Index i = 0; i < archive.windows->count(); i += stride)
    if (std::find(components.begin(), components.end(), archive.mixture->labels(i)) != components.end())
      columns.push_back(i);
  const Eigen::MatrixXd& features = archive.mixture->features;
  return (features.size() > 0 ? features : archive.windows->parameters)(axes, columns).transpose();
}

/// The bank's modes that figures tell apart, at `axes`.
Eigen::MatrixXd modes_at(const Archive& archive, const std::vector<Index>& axes) {
  if (!archive.bank || archive.mixture->features.size() > 0) return Eigen::MatrixXd(0, std::ssize(axes));
  const std::vector<Index> modes = shown_modes(archive).shown;
  Eigen::MatrixXd rows(std::ssize(modes), std::ssize(axes));
  for (Index i = 0; i < rows.rows(); ++i) {
    const Index k = modes[static_cast<std::size_t>(i)];
    const Mode& mode = archive.bank->modes[static_cast<std::size_t>(k)];
    const Eigen::VectorXd theta = archive.bank->motion_parameters.empty() ? archive.bank->theta(k) : mode.motion_theta;
    if (axes.back() >= theta.size()) return Eigen::MatrixXd(0, std::ssize(axes));  // of another model
    rows.row(i) = theta(axes).transpose();
  }
  return rows;
}

/// Three blocks per component, one per panel.
void add_ellipses(const GaussianMixture& mixture, const std::vector<Index>& components, const std::vector<Index>& axes,
                  Figure& figure) {
  const std::vector<std::pair<std::size_t, std::size_t>> panels{{0, 1}, {0, 2}, {1, 2}};
  for (const Index k : components)
    for (const auto& [first, second] : panels) {
      Eigen::MatrixXd boundary(0, 2);
      if (second < axes.size()) {
        const std::vector<Index> at{axes[first], axes[second]};
        boundary =
            confidence_ellipse(mixture.means.col(k)(at), mixture.covariances[static_cast<std::size_t>(k)](at, at),
                               ellipse_level, ellipse_points)
                .transpose();
      }
      figure.add_block(fmt::format("95 % ellipse of component {}, axes {} and {}", k, first + 1, second + 1),
                       {"first", "second"}, boundary);
    }
}

/// Names of the axes that a cloud can have: of the windows' parameters, or of what was clustered in their place.
std::vector<std::string> axis_names(const Archive& archive) {
  return archive.mixture->features.size() > 0 ? archive.mixture->feature_names : archive.windows->parameter_names();
}

/// ", wz <- velL in (rad/s)/(m/s)": panels are too narrow for it.
std::string units_words(const Archive& archive, const std::vector<Index>& axes,
                        const std::vector<std::string>& labels) {
  const Unit units =
      feature_units(axis_names(archive), *archive.windows, Units(archive.recording.value_or(Recording())));
  std::string words;
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (const std::string& unit = units[static_cast<std::size_t>(axes[i])]; !unit.empty() && unit != "1")
      words += fmt::format("; {} in {}", labels[i], unit);
  return words;
}

/// The components that are told apart, the heaviest first: the points of the lighter ones lie over theirs.
std::vector<Index> by_weight(const GaussianMixture& mixture, std::vector<Index> components) {
  std::stable_sort(components.begin(), components.end(),
                   [&](Index a, Index b) { return mixture.weights(a) > mixture.weights(b); });
  return components;
}

void name_components(const GaussianMixture& mixture, const ShownGroups& groups, const std::vector<Index>& order,
                     Figure& figure) {
  const Palette colours = palette();
  std::vector<std::string> titles, used;
  for (const Index k : order) {
    titles.push_back(fmt::format("{} ({:.0f} %)", k, 100 * mixture.weights(k)));
    const auto position = std::find(groups.shown.begin(), groups.shown.end(), k) - groups.shown.begin();
    used.push_back(colours.modes.at(static_cast<std::size_t>(position)));
  }
  figure.set("K", std::ssize(order));
  figure.set("component_title", titles);
  figure.set("component_colour", used);
  figure.set("key_title", std::string("component (weight)"));
  figure.set("rest_title", groups.any_others() ? groups.others_title() + ", none" : std::string("none"));
}

Figure local_models(const Archive& archive, const std::vector<Index>& axes) {
  const GaussianMixture& mixture = archive.mixture->mixture;
  const ShownGroups groups = shown_groups(mixture.weights);
  const std::vector<Index> order = by_weight(mixture, groups.shown);
  Figure figure("local_models", assets::figure_local_models());
  const std::vector<std::string> all = feature_labels(archive, axis_names(archive));
  std::vector<std::string> labels;
  for (const Index axis : axes) labels.push_back(all[static_cast<std::size_t>(axis)]);
  figure.set("axes", static_cast<Index>(axes.size()));
  figure.set("axis_label", labels);
  name_components(mixture, groups, order, figure);
  const Index stride = std::max<Index>(1, (archive.windows->count() + most_points - 1) / most_points);
  for (const Index k : order)
    figure.add_block(fmt::format("windows of component {}, one in {}", k, stride), labels,
                     points_of(archive, {k}, stride, axes));
  std::vector<Index> rest = groups.others;
  rest.push_back(-1);
  figure.add_block(fmt::format("all other windows, one in {}", stride), labels, points_of(archive, rest, stride, axes));
  add_ellipses(mixture, order, axes, figure);
  const Eigen::MatrixXd modes = modes_at(archive, axes);
  figure.set("modes", modes.rows());
  figure.add_block("modes of the bank", labels, modes);
  figure.set_caption(
      fmt::format("Local models{} of {} windows, coloured by mixture component, with the components' 95 % "
                  "ellipses{}{}.",
                  features_origin(archive).empty() ? "" : " with one lag", archive.windows->count(),
                  modes.rows() > 0 ? "; diamonds: modes of the bank" : "", units_words(archive, axes, labels)));
  return figure;
}

Figure selection(const std::vector<Candidate>& candidates) {
  Figure figure("selection", assets::figure_selection());
  Eigen::MatrixXd rows(static_cast<Index>(candidates.size()), 6);
  for (Index i = 0; i < rows.rows(); ++i) {
    const Candidate& c = candidates[static_cast<std::size_t>(i)];
    rows.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    rows(i, 0) = static_cast<double>(c.components);
    if (c.status != CandidateStatus::fitted) continue;
    rows.row(i).tail(5) << c.bic, c.icl, c.aic, c.heldout,
        static_cast<double>(c.agreeing_restarts) / std::max(1.0, static_cast<double>(c.restarts));
    if (c.selected) figure.set("chosen", c.components);
  }
  figure.set("first", candidates.front().components);
  figure.set("last", candidates.back().components);
  figure.set("heldout", static_cast<Index>(rows.col(4).array().isFinite().any()));
  figure.add_block("candidates", {"components", "BIC", "ICL", "AIC", "held out", "agreeing restarts"}, rows);
  figure.set_caption(
      "Criteria over the number of mixture components: lower is better for BIC, ICL and AIC, higher for the "
      "held-out score; the bar marks the choice.");
  return figure;
}

}  // namespace

void add_window_figures(const Archive& archive, FigureSet& set) {
  if (!archive.windows || !archive.mixture) {
    set.left_out.emplace_back("local_models and selection: the archive holds no mixture");
    return;
  }
  const std::vector<Index> axes = projection_axes(axis_names(archive));
  if (axes.size() >= 2)
    set.figures.push_back(local_models(archive, axes));
  else
    set.left_out.emplace_back("local_models: the model has one parameter");
  if (archive.mixture->candidates.size() >= 2)
    set.figures.push_back(selection(archive.mixture->candidates));
  else
    set.left_out.emplace_back("selection: there was one candidate");
}

}  // namespace modebank::app::report
