#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/switching/regression.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

constexpr double duplicate_significance = 0.95;  // level of the likelihood-ratio test that separates two modes
constexpr double power_ridge = 1e-12;  // share of the regressors' power; makes regressions without excitation solvable

/// 1/2 W log det of the residual covariance, for least squares of these transitions.
double cost(const RegressionSums& sums) {
  Eigen::MatrixXd normal = sums.G;
  normal.diagonal().array() += power_ridge * std::max(sums.G.trace(), std::numeric_limits<double>::min());
  const Eigen::MatrixXd Q = (sums.S - sums.H.transpose() * solve_semidefinite(normal, sums.H)) / sums.weight;
  const Eigen::VectorXd pivots = semidefinite_pivots(Q).cwiseMax(std::numeric_limits<double>::min());
  return 0.5 * sums.weight * pivots.array().log().sum();
}

struct DuplicateModes {
  Index kept, dropped;
};

/// The pair of modes whose pooling costs least, of those that cost less than `most(i, j)` nats.
template <class Most>
std::optional<DuplicateModes> closest_duplicates(const std::vector<RegressionSums>& modes, Most most) {
  std::optional<DuplicateModes> duplicates;
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < std::ssize(modes); ++i)
    for (Index j = i + 1; j < std::ssize(modes); ++j) {
      const double loss = cost(modes[i] + modes[j]) - cost(modes[i]) - cost(modes[j]);
      if (!(loss < least && loss < most(i, j))) continue;
      least = loss;
      duplicates = modes[i].weight >= modes[j].weight ? DuplicateModes{i, j} : DuplicateModes{j, i};
    }
  return duplicates;
}

/// Removes one mode. The probabilities of switching to it are distributed over the other modes in proportion.
void drop_mode(Index mode, SwitchingRegression& model) {
  std::vector<Index> rest(model.modes());
  std::iota(rest.begin(), rest.end(), Index{0});
  rest.erase(rest.begin() + mode);
  model.theta = model.theta(Eigen::all, rest).eval();
  model.Q.erase(model.Q.begin() + mode);
  if (!model.motion.empty()) {
    const bool last_of_motion = std::ranges::count(model.motion, model.motion[mode]) == 1;
    for (Index j = mode + 1; last_of_motion && j < std::ssize(model.motion); ++j) --model.motion[j];
    model.motion.erase(model.motion.begin() + mode);
  }
  model.transition = model.transition(rest, rest).eval();
  model.transition = (model.transition.array().colwise() / model.transition.array().rowwise().sum()).eval();
  model.initial = model.initial(rest).eval();
  model.initial /= model.initial.sum();
  if (!model.logit.empty()) model.logit.weights = model.logit.weights(rest, Eigen::all).eval();
}

/// Adds the data of the removed mode to the remaining mode of the pair, with the weights of the modes.
void merge(const DuplicateModes& pair, const std::vector<RegressionSums>& modes, SwitchingRegression& model) {
  const double kept = modes[pair.kept].weight, dropped = modes[pair.dropped].weight;
  const auto pool_rows = [&](Eigen::MatrixXd& rows) {
    rows.row(pair.kept) = (kept * rows.row(pair.kept) + dropped * rows.row(pair.dropped)).eval() / (kept + dropped);
  };
  pool_rows(model.transition);
  model.transition.col(pair.kept) += model.transition.col(pair.dropped);
  if (!model.logit.empty()) pool_rows(model.logit.weights);
  model.initial(pair.kept) += model.initial(pair.dropped);
  drop_mode(pair.dropped, model);
}

double radius(const LinearStructure& structure, const SwitchingRegression& model, Index j) {
  return spectral_radius(unpack(structure, model.theta.col(j)));
}

}  // namespace

std::optional<ScreenedMode> drop_worst_mode(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                            SwitchingRegression& model) {
  if (model.modes() < 2 || model.noise_levels > 1) return std::nullopt;
  const LinearStructure& structure = transitions.structure;
  // The sums are taken about a point near every mode, so that few digits are lost.
  const std::vector<RegressionSums> modes = sums_of_modes(transitions, posterior, model.theta.rowwise().mean());
  const auto mode = [&](Index j, const std::string& reason) {
    const double share = modes[j].weight / transitions.usable.sum();
    return ScreenedMode{j, share, radius(structure, model, j), reason + " after refinement"};
  };
  const double unused = least_unstable_share * transitions.usable.sum();
  Index fewest = 0, fastest = -1;  // -1: no unstable mode that is hardly used
  double largest = 1.0 + spectral_radius_slack;
  for (Index j = 0; j < model.modes(); ++j) {
    if (modes[j].weight < modes[fewest].weight) fewest = j;
    if (modes[j].weight >= unused || !(radius(structure, model, j) > largest)) continue;
    fastest = j;
    largest = radius(structure, model, j);
  }
  const bool starved = modes[fewest].weight < static_cast<double>(structure.regressors() + 1);
  if (starved || fastest >= 0) {
    ScreenedMode dropped = starved ? mode(fewest, "starved") : mode(fastest, "unstable");
    drop_mode(starved ? fewest : fastest, model);
    return dropped;
  }
  const Index of_theta = structure.parameters(), of_Q = structure.states * (structure.states + 1) / 2;
  const auto by_chance = [&](Index i, Index j) {
    const Index numbers = (model.end_of_motion(i) > j ? 0 : of_theta) + of_Q;
    return 0.5 * chi_square_quantile(duplicate_significance, static_cast<double>(numbers));
  };
  const std::optional<DuplicateModes> duplicates = closest_duplicates(modes, by_chance);
  if (!duplicates) return std::nullopt;
  ScreenedMode dropped = mode(duplicates->dropped, fmt::format("duplicate of mode {}", duplicates->kept));
  merge(*duplicates, modes, model);
  return dropped;
}

void merge_closest_pair(const TrainingTransitions& transitions, const ModePosterior& posterior,
                        SwitchingRegression& model) {
  const std::vector<RegressionSums> modes = sums_of_modes(transitions, posterior, model.theta.rowwise().mean());
  if (const auto closest =
          closest_duplicates(modes, [](Index, Index) { return std::numeric_limits<double>::infinity(); }))
    merge(*closest, modes, model);
}

}  // namespace modebank
