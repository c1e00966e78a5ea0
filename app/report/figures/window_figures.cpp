#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/report/figures/confidence_ellipse.hpp"
#include "app/report/figures/run_figures.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/summary_text.hpp"
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

/// Windows of component k (-1: of none), every `stride`-th, their parameters at `axes`.
Eigen::MatrixXd points_of(const Archive& archive, int k, Index stride, const std::vector<Index>& axes) {
  std::vector<Index> columns;
  for (Index i = 0; i < archive.windows->count(); i += stride)
    if (archive.mixture->labels(i) == k) columns.push_back(i);
  Eigen::MatrixXd rows(static_cast<Index>(columns.size()), static_cast<Index>(axes.size()));
  for (Index r = 0; r < rows.rows(); ++r)
    for (Index c = 0; c < rows.cols(); ++c)
      rows(r, c) = archive.windows->parameters(axes[static_cast<std::size_t>(c)], columns[static_cast<std::size_t>(r)]);
  return rows;
}

/// Three blocks per component, one per panel.
void add_ellipses(const GaussianMixture& mixture, const std::vector<Index>& axes, Figure& figure) {
  const std::vector<std::pair<std::size_t, std::size_t>> panels{{0, 1}, {0, 2}, {1, 2}};
  for (Index k = 0; k < mixture.components(); ++k)
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

std::string label_of(const Archive& archive, std::size_t parameter) {
  const WindowFits& fits = *archive.windows;
  const Units units(archive.recording.value_or(Recording()));
  const Unit all = fits.model_parameters.empty() ? parameter_units(fits.structure, units.states(), units.inputs())
                                                 : unit_of(fits.model_parameters);
  const std::string unit = parameter < all.size() && all[parameter] != "1" ? all[parameter] : "";
  return with_unit(window_labels(archive)[parameter], unit);
}

Figure local_models(const Archive& archive, const std::vector<Index>& axes) {
  const GaussianMixture& mixture = archive.mixture->mixture;
  Figure figure("local_models", assets::figure_local_models());
  std::vector<std::string> labels, titles;
  for (const Index axis : axes) labels.push_back(label_of(archive, static_cast<std::size_t>(axis)));
  for (Index k = 0; k < mixture.components(); ++k)
    titles.push_back(fmt::format("{} ({:.0f} %)", k, 100 * mixture.weights(k)));
  figure.set("K", mixture.components());
  figure.set("axes", static_cast<Index>(axes.size()));
  figure.set("axis_label", labels);
  figure.set("component_title", titles);
  figure.set("key_title", std::string("component (weight)"));
  figure.set("rest_title", std::string("none"));
  const Index stride = (archive.windows->count() + most_points - 1) / most_points;
  for (Index k = 0; k <= mixture.components(); ++k) {
    const int label = k < mixture.components() ? static_cast<int>(k) : -1;
    figure.add_block(fmt::format("windows of component {}, one in {}", label, stride), labels,
                     points_of(archive, label, std::max<Index>(1, stride), axes));
  }
  add_ellipses(mixture, axes, figure);
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
  return figure;
}

}  // namespace

void add_window_figures(const Archive& archive, FigureSet& set) {
  if (!archive.windows || !archive.mixture) {
    set.left_out.emplace_back("local_models and selection: the archive holds no mixture");
    return;
  }
  const std::vector<Index> axes = projection_axes(archive.windows->parameter_names());
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
