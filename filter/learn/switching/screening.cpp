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

/// The pair of modes whose pooling costs least, if the cost is below `least` nats.
std::optional<DuplicateModes> closest_duplicates(const std::vector<RegressionSums>& modes, double least) {
  std::optional<DuplicateModes> duplicates;
  for (Index i = 0; i < std::ssize(modes); ++i)
    for (Index j = i + 1; j < std::ssize(modes); ++j) {
      const double loss = cost(modes[i] + modes[j]) - cost(modes[i]) - cost(modes[j]);
      if (!(loss < least)) continue;
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

double mean_square_growth(const LinearStructure& structure, const SwitchingRegression& model) {
  const Index n = structure.dimension(), K = model.modes();
  std::vector<Eigen::MatrixXd> F;
  bool one_motion = true;
  for (Index j = 0; j < K; ++j) {
    F.push_back(unpack(structure, model.theta.col(j)).full_form());
    if (!F.back().allFinite()) return std::numeric_limits<double>::infinity();
    one_motion = one_motion && F.back() == F.front();
  }
  // If all modes have one motion, the sum of their moments evolves like the moment of a single mode, because rows of T
  // sum to one. A root of the n x n matrix is exact even if the larger operator has multiple eigenvalues.
  if (one_motion) return std::pow(radius(structure, model, 0), 2);
  const auto after_a_step = [&](const Eigen::VectorXd& moments) -> Eigen::VectorXd {
    Eigen::MatrixXd moved = moments.reshaped(n * n, K);
    for (Index i = 0; i < K; ++i) {
      const Eigen::MatrixXd& of_mode = F[i];
      moved.col(i) = (of_mode * moved.col(i).reshaped(n, n) * of_mode.transpose()).eval().reshaped();
    }
    return (moved * model.transition).reshaped();
  };
  // The operator maps positive semidefinite matrices to positive semidefinite matrices. So its spectral radius is an
  // eigenvalue (Krein & Rutman 1948), and no other eigenvalue has a larger real part.
  const Eigen::MatrixXd white = Eigen::MatrixXd::Identity(n, n);
  return largest_real_eigenvalue(after_a_step, white.reshaped().replicate(K, 1));
}

std::optional<ScreenedMode> drop_worst_mode(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                            bool one_theta, SwitchingRegression& model) {
  if (model.modes() < 2) return std::nullopt;
  const LinearStructure& structure = transitions.structure;
  // The sums are taken about a point near every mode, so that few digits are lost.
  const std::vector<RegressionSums> modes = sums_of_modes(transitions, posterior, model.theta.rowwise().mean());
  const auto mode = [&](Index j, const std::string& reason) {
    const double share = modes[j].weight / transitions.usable.sum();
    return ScreenedMode{j, share, radius(structure, model, j), reason + " after refinement"};
  };
  Index fewest = 0, fastest = 0;
  for (Index j = 1; j < model.modes(); ++j) {
    if (modes[j].weight < modes[fewest].weight) fewest = j;
    if (radius(structure, model, j) > radius(structure, model, fastest)) fastest = j;
  }
  const bool starved = modes[fewest].weight < static_cast<double>(structure.regressors() + 1);
  if (starved || (radius(structure, model, fastest) > 1.0 + spectral_radius_slack &&
                  mean_square_growth(structure, model) > 1.0 + growth_slack)) {
    ScreenedMode dropped = starved ? mode(fewest, "starved") : mode(fastest, "unstable");
    drop_mode(starved ? fewest : fastest, model);
    return dropped;
  }
  const Index of_theta = one_theta ? 0 : structure.parameters(), of_Q = structure.states * (structure.states + 1) / 2;
  const double by_chance = 0.5 * chi_square_quantile(duplicate_significance, static_cast<double>(of_theta + of_Q));
  const std::optional<DuplicateModes> duplicates = closest_duplicates(modes, by_chance);
  if (!duplicates) return std::nullopt;
  ScreenedMode dropped = mode(duplicates->dropped, fmt::format("duplicate of mode {}", duplicates->kept));
  merge(*duplicates, modes, model);
  return dropped;
}

void merge_closest_pair(const TrainingTransitions& transitions, const ModePosterior& posterior,
                        SwitchingRegression& model) {
  const std::vector<RegressionSums> modes = sums_of_modes(transitions, posterior, model.theta.rowwise().mean());
  if (const auto closest = closest_duplicates(modes, std::numeric_limits<double>::infinity()))
    merge(*closest, modes, model);
}

}  // namespace modebank
