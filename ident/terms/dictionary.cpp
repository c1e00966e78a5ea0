#include "ident/terms/dictionary.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/base/sample_quantile.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_regressors = 8, most_directions = 4, newest_inputs = 2;
constexpr int knots = 13;
constexpr double first_quantile = 0.05, quantile_step = 0.075;
constexpr double regressor_ridge = 1e-8;  // share of the number of rows; columns have unit root mean square

/// The regressors (without the constant) that a forward selection for a linear fit of the targets takes first.
std::vector<Index> leading_regressors(const LinearStructure& s, const MatrixXd& X, const MatrixXd& targets) {
  const Index q = s.regressors() - (s.intercept ? 1 : 0);
  const double N = static_cast<double>(X.rows());
  const VectorXd rms = (X.leftCols(q).colwise().squaredNorm() / N).cwiseSqrt().transpose();
  MatrixXd scaled = X.leftCols(q);
  for (Index j = 0; j < q; ++j) scaled.col(j) /= rms(j) > 0.0 ? rms(j) : 1.0;
  const MatrixXd G = scaled.transpose() * scaled, H = scaled.transpose() * targets;
  std::vector<Index> taken;
  while (std::ssize(taken) < std::min(q, most_regressors)) {
    Index best = -1;
    double most = -1.0;
    for (Index j = 0; j < q; ++j) {
      if (rms(j) == 0.0 || std::find(taken.begin(), taken.end(), j) != taken.end()) continue;
      std::vector<Index> with = taken;
      with.push_back(j);
      MatrixXd A = G(with, with);
      A.diagonal().array() += regressor_ridge * N;
      const MatrixXd h = H(with, Eigen::all);
      const double explained = h.cwiseProduct(solve_semidefinite(A, h)).sum();
      if (explained > most) {
        most = explained;
        best = j;
      }
    }
    if (best < 0) break;
    taken.push_back(best);
  }
  return taken;
}

/// All directions, grouped by kind. If their number is limited, the most important directions of each state are kept.
std::vector<VectorXd> directions(const LinearStructure& s, const MatrixXd& fit) {
  std::vector<VectorXd> all;
  const Index n = s.dimension(), m = s.inputs;
  const auto add = [&](const VectorXd& direction) {
    const Index entries = (direction.array() != 0.0).count();
    // a direction with a single nonzero entry is a regressor
    if (entries > 1 && std::ssize(all) < most_directions) all.push_back(direction);
  };
  const auto part = [&](Index state, Index first, Index count) {
    VectorXd direction = VectorXd::Zero(s.regressors());
    direction.segment(first, count) = fit.col(state).segment(first, count);
    return direction;
  };
  for (Index i = 0; i < s.states; ++i) add(part(i, n, s.acting_inputs()));
  for (Index i = 0; i < s.states; ++i) add(fit.col(i));
  for (Index lag = 0; lag < std::min(newest_inputs, s.input_lags) && s.input_lags > 1; ++lag)
    for (Index i = 0; i < s.states; ++i) add(part(i, n + lag * m, m));
  return all;
}

void add_bends(Index variable, VectorXd z, std::vector<Term>& terms) {
  std::sort(z.begin(), z.end());
  terms.push_back({TermKind::magnitude, {variable}});
  terms.push_back({TermKind::hinge, {variable}, 0.0});
  for (int i = 0; i < knots; ++i)
    terms.push_back(
        {TermKind::hinge,
         {variable},
         sample_quantile({z.data(), static_cast<std::size_t>(z.size())}, first_quantile + quantile_step * i)});
}

}  // namespace

MotionTerms make_dictionary(const LinearStructure& structure, const MatrixXd& regressors, const MatrixXd& fit,
                            const MatrixXd& targets) {
  const std::vector<Index> taken = leading_regressors(structure, regressors, targets);
  const std::vector<VectorXd> combined = directions(structure, fit);
  MotionTerms terms;
  terms.direction = MatrixXd::Zero(structure.regressors(), std::ssize(taken) + std::ssize(combined));
  for (std::size_t i = 0; i < taken.size(); ++i) terms.direction(taken[i], static_cast<Index>(i)) = 1.0;
  for (std::size_t i = 0; i < combined.size(); ++i)
    terms.direction.col(std::ssize(taken) + static_cast<Index>(i)) = combined[i];
  MatrixXd z = regressors * terms.direction;
  terms.low = z.colwise().minCoeff().transpose();
  terms.high = z.colwise().maxCoeff().transpose();
  terms.unit = (z.colwise().squaredNorm() / static_cast<double>(z.rows())).cwiseSqrt().transpose();
  for (double& unit : terms.unit)
    if (!(unit > 0.0)) unit = 1.0;
  z.array().rowwise() /= terms.unit.transpose().array();
  for (Index i = 0; i < z.cols(); ++i) {
    add_bends(i, z.col(i), terms.terms);
    for (Index j = i; j < z.cols(); ++j) {
      terms.terms.push_back({TermKind::product, {i, j}});
      for (Index k = j; k < z.cols(); ++k) terms.terms.push_back({TermKind::product, {i, j, k}});
    }
  }
  return terms;
}

}  // namespace modebank
