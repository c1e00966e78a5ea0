#include "filter/refine_screening.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "filter/calibration.hpp"
#include "filter/screening.hpp"

namespace modebank {
namespace {

constexpr double significance = 0.95;
constexpr double ridge = 1e-12;  // share of the regressors' power: keeps unexcited regressions solvable

/// Weighted regression statistics, additive over modes: pooling two modes adds them.
struct Pooled {
  Eigen::MatrixXd G, H, S;
  double weight = 0.0;

  Pooled operator+(const Pooled& other) const { return {G + other.G, H + other.H, S + other.S, weight + other.weight}; }

  /// 1/2 W log det of the residual covariance about the least squares of these transitions.
  double cost() const {
    Eigen::MatrixXd normal = G;
    normal.diagonal().array() += ridge * std::max(G.trace(), std::numeric_limits<double>::min());
    const Eigen::MatrixXd Q = (S - H.transpose() * normal.ldlt().solve(H)) / weight;
    const Eigen::VectorXd pivots = Q.ldlt().vectorD().cwiseMax(std::numeric_limits<double>::min());
    return 0.5 * weight * pivots.array().log().sum();
  }
};

std::vector<Pooled> statistics(const TrainingTransitions& transitions, const ModePosterior& posterior,
                               const SwitchingRegression& model) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::VectorXd middle = model.theta.rowwise().mean();  // near every mode, so that little cancels
  const Eigen::MatrixXd r = transitions.data.increments - X * coefficients(transitions.structure, middle);
  std::vector<Pooled> modes;
  for (Index j = 0; j < model.modes(); ++j) {
    const Eigen::VectorXd w = posterior.probability.col(j).cwiseProduct(transitions.usable);
    const Eigen::MatrixXd weighted = w.asDiagonal() * X;
    modes.push_back({weighted.transpose() * X, weighted.transpose() * r, r.transpose() * w.asDiagonal() * r, w.sum()});
  }
  return modes;
}

struct Twins {
  Index kept = 0, dropped = 0;
};

Index free_parameters(const LinearStructure& structure, SharedParts shared) {
  const Index theta = structure.parameters(), noise = structure.states * (structure.states + 1) / 2;
  return (shared == SharedParts::theta ? 0 : theta) + (shared == SharedParts::noise ? 0 : noise);
}

/// The pair of modes that is closest, if it is closer than a test can tell.
std::optional<Twins> closest_twins(const LinearStructure& structure, const std::vector<Pooled>& modes,
                                   SharedParts shared) {
  std::optional<Twins> twins;
  double least = 0.5 * chi_square_quantile(significance, static_cast<double>(free_parameters(structure, shared)));
  for (std::size_t i = 0; i < modes.size(); ++i)
    for (std::size_t j = i + 1; j < modes.size(); ++j) {
      const double loss = (modes[i] + modes[j]).cost() - modes[i].cost() - modes[j].cost();
      if (!(loss < least)) continue;
      least = loss;
      const bool first = modes[i].weight >= modes[j].weight;
      twins = {static_cast<Index>(first ? i : j), static_cast<Index>(first ? j : i)};
    }
  return twins;
}

Eigen::MatrixXd without(const Eigen::MatrixXd& columns, Index drop) {
  Eigen::MatrixXd rest(columns.rows(), columns.cols() - 1);
  rest << columns.leftCols(drop), columns.rightCols(columns.cols() - drop - 1);
  return rest;
}

/// Leaves one mode out; what led to it or from it is spread over the others as they are.
void drop_mode(Index mode, SwitchingRegression& model) {
  model.theta = without(model.theta, mode);
  model.Q.erase(model.Q.begin() + mode);
  const Eigen::MatrixXd rows = without(model.transition.transpose(), mode).transpose();
  model.transition = without(rows, mode);
  for (Index i = 0; i < model.transition.rows(); ++i) model.transition.row(i) /= model.transition.row(i).sum();
  model.initial = without(model.initial.transpose(), mode).transpose();
  model.initial /= model.initial.sum();
}

/// Gives the twin what belonged to the dropped mode, weighted as the modes are.
void merge_sequence(const Twins& twins, const std::vector<Pooled>& modes, SwitchingRegression& model) {
  const double kept = modes[static_cast<std::size_t>(twins.kept)].weight;
  const double dropped = modes[static_cast<std::size_t>(twins.dropped)].weight;
  Eigen::MatrixXd& T = model.transition;
  T.row(twins.kept) = ((kept * T.row(twins.kept) + dropped * T.row(twins.dropped)) / (kept + dropped)).eval();
  T.col(twins.kept) += T.col(twins.dropped);
  model.initial(twins.kept) += model.initial(twins.dropped);
}

double radius(const LinearStructure& structure, const SwitchingRegression& model, Index j) {
  return spectral_radius(unpack(structure, model.theta.col(j)));
}

/// Slack above 1 for growth that power iteration knows to no more digits: an integrator stays.
constexpr double growth_slack = 1e-4;

}  // namespace

double mean_square_growth(const LinearStructure& structure, const SwitchingRegression& model) {
  constexpr int most = 2000;
  constexpr double tolerance = 1e-7;
  const Index n = structure.dimension(), K = model.modes();
  std::vector<Eigen::MatrixXd> F, X(static_cast<std::size_t>(K), Eigen::MatrixXd::Identity(n, n));
  for (Index j = 0; j < K; ++j) F.push_back(unpack(structure, model.theta.col(j)).full_form());
  double growth = 0.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    std::vector<Eigen::MatrixXd> next(X.size(), Eigen::MatrixXd::Zero(n, n));
    double trace = 0.0, trace_before = 0.0;
    for (std::size_t i = 0; i < X.size(); ++i) {
      const Eigen::MatrixXd moved = F[i] * X[i] * F[i].transpose();
      for (std::size_t j = 0; j < X.size(); ++j)
        next[j] += model.transition(static_cast<Index>(i), static_cast<Index>(j)) * moved;
      trace_before += X[i].trace();
      trace += moved.trace();
    }
    if (!(trace > 0.0)) return 0.0;
    const double before = growth;
    growth = trace / trace_before;
    for (std::size_t j = 0; j < X.size(); ++j) X[j] = next[j] / trace;
    if (std::abs(growth - before) <= tolerance * growth) break;
  }
  return growth;
}

bool screen_worst_mode(const LinearStructure& structure, const TrainingTransitions& transitions,
                       const ModePosterior& posterior, SharedParts shared, SwitchingRegression& model,
                       std::vector<ScreenedMode>& screened) {
  if (model.modes() < 2) return false;
  const std::vector<Pooled> modes = statistics(transitions, posterior, model);
  const auto list = [&](Index j, const std::string& reason) {
    const double share = modes[static_cast<std::size_t>(j)].weight / static_cast<double>(transitions.usable.sum());
    screened.push_back({j, share, radius(structure, model, j), reason});
  };
  Index starved = -1, unstable = -1;
  double fewest = static_cast<double>(structure.regressors() + 1), largest = 1.0 + spectral_radius_slack;
  for (Index j = 0; j < model.modes(); ++j) {
    if (const double weight = modes[static_cast<std::size_t>(j)].weight; weight < fewest) {
      fewest = weight;
      starved = j;
    }
    if (const double r = radius(structure, model, j); r > largest) {
      largest = r;
      unstable = j;
    }
  }
  if (unstable >= 0 && mean_square_growth(structure, model) <= 1.0 + growth_slack) unstable = -1;
  if (const Index j = starved >= 0 ? starved : unstable; j >= 0) {
    list(j, starved >= 0 ? "starved after refinement" : "unstable after refinement");
    drop_mode(j, model);
    return true;
  }
  const std::optional<Twins> twins = closest_twins(structure, modes, shared);
  if (!twins) return false;
  list(twins->dropped, fmt::format("duplicate of mode {} after refinement", twins->kept));
  merge_sequence(*twins, modes, model);
  drop_mode(twins->dropped, model);
  return true;
}

}  // namespace modebank
