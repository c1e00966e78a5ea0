#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "app/report/page/mode_map.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/judged_runs.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "ident/model/parameter_labels.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

constexpr Index line_points = 201, map_points = 61;  // number of points along an axis of a line plot and of a map
constexpr Index most_samples = 3000;                 // largest number of samples that are drawn
/// effect on the log odds, relative to the first feature; a second feature with a smaller effect is not drawn
constexpr double least_second_effect = 0.05;

/// States and inputs at the start of each step, and the most probable mode after the step.
struct SeenSamples {
  std::vector<Eigen::VectorXd> z;
  std::vector<Index> mode;
};

using Visit = std::function<void(const Eigen::VectorXd& z, Index mode)>;

/// The lagged state at a sample. It comes from the filter's states, or from measurements before the filter starts.
Eigen::VectorXd lagged_state(const LinearStructure& structure, const Trajectory& run, const RunEvaluation& said,
                             Index sample) {
  Eigen::VectorXd state(structure.dimension());
  for (Index lag = 0; lag < structure.state_lags; ++lag) {
    const auto filtered = said.state.col(sample - lag);
    state.segment(lag * structure.states, structure.states) =
        filtered.allFinite() ? filtered : run.state.col(sample - lag);
  }
  return state;
}

void visit_run(const Bank& bank, const Trajectory& run, const RunEvaluation& said, const Visit& visit) {
  Eigen::VectorXd z(bank.transition_logit.weights.cols());
  Index known = 0;  // number of earlier samples, counted while steps have the model's period
  RunSamples(bank, run).for_each([&](const SampleFeed& feed, Index k, bool starts) {
    if (starts) {
      known = bank.structure.state_lags;
      return;
    }
    if (feed.steps() != 1) known = 1;
    if (feed.steps() != 1 || known++ < bank.structure.state_lags) return;
    z << lagged_state(bank.structure, run, said, k - 1), feed.inputs();
    if (!z.allFinite() || !said.mode_probability.col(k).allFinite()) return;
    Index mode = 0;
    said.mode_probability.col(k).maxCoeff(&mode);
    visit(z, mode);
  });
}

void visit_all(const Archive& archive, const FilterEvaluation& evaluation, const Visit& visit) {
  for (std::size_t i = 0; i < evaluation.runs.size(); ++i)
    evaluation.with_run(i, {"state", "mode_probability"}, [&](const RunEvaluation& said) {
      visit_run(*archive.bank, archive.recording->runs[i], said, visit);
    });
}

/// The samples of all runs. If there are too many, only every k-th sample is used.
SeenSamples seen_samples(const Archive& archive) {
  SeenSamples thin;
  const FilterEvaluation* const evaluation = evaluation_of(archive, "bank");
  if (!evaluation) return thin;
  Index count = 0, i = 0;
  visit_all(archive, *evaluation, [&](const Eigen::VectorXd&, Index) { ++count; });
  const Index every = std::max<Index>(1, (count + most_samples - 1) / most_samples);
  visit_all(archive, *evaluation, [&](const Eigen::VectorXd& z, Index mode) {
    if (i++ % every != 0) return;
    thin.z.push_back(z);
    thin.mode.push_back(mode);
  });
  return thin;
}

Eigen::VectorXd values_of(const SeenSamples& seen, Index feature) {
  Eigen::VectorXd values(std::ssize(seen.z));
  for (Index i = 0; i < values.size(); ++i) values(i) = seen.z[static_cast<std::size_t>(i)](feature);
  return values;
}

/// For each feature, the largest change in the log odds of two modes if the feature changes by one standard deviation.
Eigen::VectorXd effects(const TransitionLogit& logit, const SeenSamples& seen) {
  Eigen::VectorXd effect(logit.weights.cols());
  for (Index a = 0; a < effect.size(); ++a) {
    const Eigen::VectorXd values = values_of(seen, a);
    const double spread = std::sqrt((values.array() - values.mean()).square().mean());
    effect(a) = spread * (logit.weights.col(a).maxCoeff() - logit.weights.col(a).minCoeff());
  }
  return effect;
}

/// The one or two features with the largest effects, the largest first.
std::vector<Index> drawn_features(const Eigen::VectorXd& effect) {
  std::vector<Index> order(static_cast<std::size_t>(effect.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return effect(a) > effect(b); });
  const bool one = order.size() < 2 || effect(order[1]) < least_second_effect * effect(order[0]);
  order.resize(one ? 1 : 2);
  return order;
}

/// Name of a feature as in the page's tables, with the unit of its channel.
std::string feature_name(const Bank& bank, const Recording& recording, Index feature) {
  const Index n = bank.structure.dimension();
  const auto label = regressor_labels(bank.structure, bank.state_names, bank.input_names);
  const Units units(recording);
  const Unit of = feature < n ? units.states() : units.inputs();
  const auto channel =
      static_cast<std::size_t>(feature < n ? feature % bank.structure.states : (feature - n) % bank.structure.inputs);
  return with_unit(label.at(static_cast<std::size_t>(feature)),
                   channel < of.size() && of[channel] != "1" ? of[channel] : "");
}

Eigen::VectorXd axis_values(const Eigen::VectorXd& seen, Index points) {
  const double low = seen.minCoeff(), high = seen.maxCoeff(), margin = 0.03 * std::max(high - low, 1e-12);
  return Eigen::VectorXd::LinSpaced(points, low - margin, high + margin);
}

json numbers(const Eigen::VectorXd& values) { return std::vector<double>(values.begin(), values.end()); }

/// The share of time in each mode, along one feature.
json lines(const Bank& bank, Index feature, const Eigen::VectorXd& along) {
  Eigen::MatrixXd shares(bank.mode_count(), along.size());
  Eigen::VectorXd z = bank.transition_logit.reference;
  for (Index i = 0; i < along.size(); ++i) {
    z(feature) = along(i);
    shares.col(i) = settled_shares(bank, z);
  }
  json rows = json::array();
  for (Index k = 0; k < shares.rows(); ++k) rows.push_back(numbers(shares.row(k)));
  return rows;
}

/// Adds the mode with the largest share at each point of two features, and this share. The order is row by row from the
/// bottom.
void add_map(const Bank& bank, const std::vector<Index>& feature, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
             json& to) {
  json modes = json::array(), shares = json::array();
  Eigen::VectorXd z = bank.transition_logit.reference;
  for (const double up : y) {
    std::vector<Index> mode_row;
    std::vector<double> share_row;
    for (const double right : x) {
      z(feature[0]) = right;
      z(feature[1]) = up;
      Index mode = 0;
      share_row.push_back(settled_shares(bank, z).maxCoeff(&mode));
      mode_row.push_back(mode);
    }
    modes.push_back(mode_row);
    shares.push_back(share_row);
  }
  to["modes"] = modes;
  to["shares"] = shares;
}

}  // namespace

Eigen::VectorXd settled_shares(const Bank& bank, const Eigen::VectorXd& z) {
  const Index n = bank.structure.dimension(), K = bank.mode_count();
  TransitionWorkspace at(K, bank.transition_logit);
  const Eigen::MatrixXd& T =
      transition_at(bank.transition.matrix(), bank.transition_logit, z.head(n), z.tail(z.size() - n), at);
  // The stationary distribution p solves p' (I - T + 1 1') = 1'.
  const Eigen::MatrixXd system = Eigen::MatrixXd::Identity(K, K) - T + Eigen::MatrixXd::Ones(K, K);
  const Eigen::VectorXd p = system.transpose().partialPivLu().solve(Eigen::VectorXd::Ones(K)).cwiseMax(0.0);
  return p / p.sum();
}

nlohmann::json mode_map_of(const Archive& archive) {
  if (!archive.bank || !archive.recording || archive.bank->transition_logit.empty()) return nullptr;
  const Bank& bank = *archive.bank;
  const SeenSamples seen = seen_samples(archive);
  if (seen.z.size() < 2) return nullptr;
  const std::vector<Index> features = drawn_features(effects(bank.transition_logit, seen));
  const bool one = features.size() == 1;
  json map = {{"one", one}, {"others", bank.transition_logit.weights.cols() > std::ssize(features)}};
  std::array<Eigen::VectorXd, 2> axis;
  json axes = json::array(), samples = json::array();
  for (std::size_t a = 0; a < features.size(); ++a) {
    const Eigen::VectorXd values = values_of(seen, features[a]);
    axis[a] = axis_values(values, one ? line_points : map_points);
    axes.push_back({{"name", feature_name(bank, *archive.recording, features[a])}, {"values", numbers(axis[a])}});
    samples.push_back(numbers(values));
  }
  map["axes"] = axes;
  map["samples"] = {{"at", samples}, {"mode", seen.mode}};
  if (one)
    map["lines"] = lines(bank, features[0], axis[0]);
  else
    add_map(bank, features, axis[0], axis[1], map);
  return map;
}

}  // namespace modebank::app::report
