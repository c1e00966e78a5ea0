#include "filter/learn/switching/screening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

constexpr double power_ridge = 1e-12;  // ridge, as a share of the regressors' power; makes regressions without
                                       // excitation solvable

/// 1/2 W log det of the residual covariance, for least squares of these transitions. The sums of pooled modes are
/// added.
double cost(const RegressionSums& sums) {
  Eigen::MatrixXd normal = sums.G;
  normal.diagonal().array() += power_ridge * std::max(sums.G.trace(), std::numeric_limits<double>::min());
  const Eigen::MatrixXd Q = (sums.S - sums.H.transpose() * solve_semidefinite(normal, sums.H)) / sums.weight;
  const Eigen::VectorXd pivots = semidefinite_pivots(Q).cwiseMax(std::numeric_limits<double>::min());
  return 0.5 * sums.weight * pivots.array().log().sum();
}

std::vector<RegressionSums> sums_of_modes(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                          const SwitchingRegression& model) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::VectorXd middle = model.theta.rowwise().mean();  // sums are taken about a point near every mode, so that
                                                                // few digits are lost
  const Eigen::MatrixXd r = transitions.data.increments - X * coefficients(transitions.structure, middle);
  std::vector<RegressionSums> modes;
  for (Index j = 0; j < model.modes(); ++j)
    modes.push_back(regression_sums(X, posterior.probability.col(j).cwiseProduct(transitions.usable), r));
  return modes;
}

struct DuplicateModes {
  Index kept = 0, dropped = 0;
};

Index free_parameters(const LinearStructure& structure, bool one_theta) {
  const Index theta = structure.parameters(), noise = structure.states * (structure.states + 1) / 2;
  return (one_theta ? 0 : theta) + noise;
}

/// The pair of modes whose pooling costs least, if the cost is below `least` nats.
std::optional<DuplicateModes> closest_duplicates(const std::vector<RegressionSums>& modes, double least) {
  std::optional<DuplicateModes> duplicates;
  for (std::size_t i = 0; i < modes.size(); ++i)
    for (std::size_t j = i + 1; j < modes.size(); ++j) {
      const double loss = cost(modes[i] + modes[j]) - cost(modes[i]) - cost(modes[j]);
      if (!(loss < least)) continue;
      least = loss;
      const bool first = modes[i].weight >= modes[j].weight;
      duplicates = {static_cast<Index>(first ? i : j), static_cast<Index>(first ? j : i)};
    }
  return duplicates;
}

Eigen::MatrixXd without(const Eigen::MatrixXd& columns, Index drop) {
  Eigen::MatrixXd rest(columns.rows(), columns.cols() - 1);
  rest << columns.leftCols(drop), columns.rightCols(columns.cols() - drop - 1);
  return rest;
}

/// Removes one mode. The probabilities of switching to it are distributed over the other modes in proportion.
void drop_mode(Index mode, SwitchingRegression& model) {
  model.theta = without(model.theta, mode);
  if (!model.logit.empty()) model.logit.weights = without(model.logit.weights.transpose(), mode).transpose();
  model.Q.erase(model.Q.begin() + mode);
  const Eigen::MatrixXd rows = without(model.transition.transpose(), mode).transpose();
  model.transition = without(rows, mode);
  for (Index i = 0; i < model.transition.rows(); ++i) model.transition.row(i) /= model.transition.row(i).sum();
  model.initial = without(model.initial.transpose(), mode).transpose();
  model.initial /= model.initial.sum();
}

/// Adds the data of the removed mode to the remaining mode of the pair, with the weights of the modes.
void merge(const DuplicateModes& duplicates, const std::vector<RegressionSums>& modes, SwitchingRegression& model) {
  const double kept = modes[static_cast<std::size_t>(duplicates.kept)].weight;
  const double dropped = modes[static_cast<std::size_t>(duplicates.dropped)].weight;
  Eigen::MatrixXd& T = model.transition;
  T.row(duplicates.kept) =
      ((kept * T.row(duplicates.kept) + dropped * T.row(duplicates.dropped)) / (kept + dropped)).eval();
  T.col(duplicates.kept) += T.col(duplicates.dropped);
  if (Eigen::MatrixXd& w = model.logit.weights; !model.logit.empty())
    w.row(duplicates.kept) =
        ((kept * w.row(duplicates.kept) + dropped * w.row(duplicates.dropped)) / (kept + dropped)).eval();
  model.initial(duplicates.kept) += model.initial(duplicates.dropped);
  drop_mode(duplicates.dropped, model);
}

double radius(const LinearStructure& structure, const SwitchingRegression& model, Index j) {
  return spectral_radius(unpack(structure, model.theta.col(j)));
}

/// The mode with the fewest effective transitions, if they are too few for a regression.
std::optional<Index> starved_mode(const LinearStructure& structure, const std::vector<RegressionSums>& modes) {
  const auto least =
      std::min_element(modes.begin(), modes.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
  if (!(least->weight < static_cast<double>(structure.regressors() + 1))) return std::nullopt;
  return least - modes.begin();
}

/// The mode with the largest spectral radius above 1. Empty if the switching system is mean-square stable with this
/// mode.
std::optional<Index> unstable_mode(const LinearStructure& structure, const SwitchingRegression& model,
                                   double growth_slack) {
  std::optional<Index> unstable;
  double largest = 1.0 + spectral_radius_slack;
  for (Index j = 0; j < model.modes(); ++j)
    if (const double r = radius(structure, model, j); r > largest) {
      largest = r;
      unstable = j;
    }
  if (unstable && mean_square_growth(structure, model) <= 1.0 + growth_slack) return std::nullopt;
  return unstable;
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
    Eigen::MatrixXd moved(n * n, K);
    for (Index i = 0; i < K; ++i) {
      const Eigen::MatrixXd& of_mode = F[static_cast<std::size_t>(i)];
      const Eigen::MatrixXd X = moments.segment(i * n * n, n * n).reshaped(n, n);
      moved.col(i) = (of_mode * X * of_mode.transpose()).reshaped();
    }
    return (moved * model.transition).reshaped();
  };
  // The operator maps positive semidefinite matrices to positive semidefinite matrices. So its spectral radius is an
  // eigenvalue (Krein & Rutman 1948), and no other eigenvalue has a larger real part.
  const Eigen::MatrixXd white = Eigen::MatrixXd::Identity(n, n);
  return largest_real_eigenvalue(after_a_step, white.reshaped().replicate(K, 1));
}

std::optional<ScreenedModel> without_worst_mode(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                                const SwitchingRegression& model, bool one_theta) {
  if (model.modes() < 2) return std::nullopt;
  const LinearStructure& structure = transitions.structure;
  const std::vector<RegressionSums> modes = sums_of_modes(transitions, posterior, model);
  const auto without_mode = [&](Index j, const std::string& reason) {
    const double share = modes[static_cast<std::size_t>(j)].weight / transitions.usable.sum();
    return ScreenedModel{model, {j, share, radius(structure, model, j), reason + " after refinement"}};
  };
  const std::optional<Index> starved = starved_mode(structure, modes);
  const std::optional<Index> useless = starved ? starved : unstable_mode(structure, model, refine_tuning.growth_slack);
  if (useless) {
    ScreenedModel rest = without_mode(*useless, starved ? "starved" : "unstable");
    drop_mode(*useless, rest.model);
    return rest;
  }
  const auto freedom = static_cast<double>(free_parameters(structure, one_theta));
  const std::optional<DuplicateModes> duplicates =
      closest_duplicates(modes, 0.5 * chi_square_quantile(refine_tuning.duplicate_significance, freedom));
  if (!duplicates) return std::nullopt;
  ScreenedModel rest = without_mode(duplicates->dropped, fmt::format("duplicate of mode {}", duplicates->kept));
  merge(*duplicates, modes, rest.model);
  return rest;
}

SwitchingRegression with_closest_pair_merged(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                             const SwitchingRegression& model) {
  const std::vector<RegressionSums> modes = sums_of_modes(transitions, posterior, model);
  SwitchingRegression rest = model;
  if (const auto duplicates = closest_duplicates(modes, std::numeric_limits<double>::infinity()))
    merge(*duplicates, modes, rest);
  return rest;
}

}  // namespace modebank
