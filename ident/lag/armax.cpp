#include "ident/lag/armax.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Polynomial = std::vector<MatrixXd>;  // n x n coefficients of 1, q^-1, ..

/// Autocovariances of M(q) v where v has covariance V, lags 0 to K - 1, one below the other.
VectorXd autocovariances(const Polynomial& M, const MatrixXd& V, Index K) {
  const Index n = V.rows();
  VectorXd result = VectorXd::Zero(K * n * n);
  for (Index lag = 0; lag < K; ++lag)
    for (std::size_t i = static_cast<std::size_t>(lag); i < M.size(); ++i)
      result.segment(lag * n * n, n * n) += (M[i] * V * M[i - static_cast<std::size_t>(lag)].transpose()).reshaped();
  return result;
}

/// (1 + d q^-1) M(q).
Polynomial times(Polynomial M, double d) {
  M.push_back(MatrixXd::Zero(M.front().rows(), M.front().cols()));
  for (std::size_t j = M.size() - 1; j > 0; --j) M[j] += d * M[j - 1];
  return M;
}

/// Nonnegative least squares (Lawson & Hanson 1974, section 23.3).
VectorXd nonnegative(const MatrixXd& A, const VectorXd& b) {
  VectorXd x = VectorXd::Zero(A.cols());
  std::vector<Index> used;
  const double tolerance = 1e-12 * (A.transpose() * b).cwiseAbs().maxCoeff();
  for (Index round = 0; round < 3 * A.cols(); ++round) {
    VectorXd gradient = A.transpose() * (b - A * x);
    for (const Index j : used) gradient(j) = 0.0;
    Index best = 0;
    if (A.cols() == 0 || !(gradient.maxCoeff(&best) > tolerance)) break;
    used.push_back(best);
    while (!used.empty()) {
      const VectorXd z = solve_least_squares(A(Eigen::all, used), b);
      double step = 1.0;
      for (std::size_t i = 0; i < used.size(); ++i)
        if (const double at = x(used[i]); z(static_cast<Index>(i)) <= 0.0)
          step = std::min(step, at / (at - z(static_cast<Index>(i))));
      x(used) += step * (z - x(used));
      if (step == 1.0) break;
      std::erase_if(used, [&](Index j) { return !(x(j) > 1e-14 * x.maxCoeff()) && ((x(j) = 0.0), true); });
    }
  }
  return x;
}

/// Columns of the least squares: R, Q, the force of a second-order motion, Q beside the diagonal, a wandering level.
MatrixXd shapes(const Polynomial& A, bool differences, Index K) {
  const Index n = A.front().rows();
  const Polynomial one{MatrixXd::Identity(n, n)};
  const auto taken = [&](const Polynomial& M) { return differences ? times(M, -1.0) : M; };
  std::vector<VectorXd> columns;
  const auto add_diagonal = [&](const Polynomial& M) {
    for (Index i = 0; i < n; ++i) columns.push_back(autocovariances(M, VectorXd::Unit(n, i).asDiagonal(), K));
  };
  add_diagonal(taken(A));
  add_diagonal(taken(one));
  // Force noise that is held between samples moves the position by an MA(1) with this root.
  if (n == 1 && A.size() == 3) add_diagonal(taken(times(one, 1.0 / (2.0 + std::sqrt(3.0)))));
  if (differences) add_diagonal(A);
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j)
      for (const double sign : {1.0, -1.0}) {
        MatrixXd V = MatrixXd::Zero(n, n);
        V(i, j) = V(j, i) = sign;
        columns.push_back(autocovariances(taken(one), V, K));
      }
  MatrixXd all(columns.front().size(), std::ssize(columns));
  for (Index j = 0; j < all.cols(); ++j) all.col(j) = columns[static_cast<std::size_t>(j)];
  return all;
}

}  // namespace

ArmaxNoise noises(const ArmaxFit& fit, const std::optional<VectorXd>& stated_R) {
  const Index n = fit.theta.rows();
  const VectorXd sd = fit.S.diagonal().cwiseSqrt();  // in units of the errors, so that no state's unit counts
  const auto scaled = [&](const MatrixXd& M) { return MatrixXd(sd.cwiseInverse().asDiagonal() * M * sd.asDiagonal()); };
  Polynomial A{MatrixXd::Identity(n, n)}, C = A;
  for (Index j = 0; j < fit.order.state_lags; ++j) A.push_back(-scaled(fit.theta.middleCols(j * n, n)));
  for (const MatrixXd& c : fit.C) C.push_back(scaled(c));
  const Index K = static_cast<Index>(std::max(A.size() + 1, C.size())) + 1;
  const MatrixXd columns = shapes(A, fit.order.differences, K);
  const VectorXd square = sd.array().square();
  VectorXd target = autocovariances(C, sd.cwiseInverse().asDiagonal() * fit.S * sd.cwiseInverse().asDiagonal(), K);
  if (stated_R) target -= columns.leftCols(n) * stated_R->cwiseQuotient(square);
  VectorXd x(columns.cols());
  if (stated_R)
    x << stated_R->cwiseQuotient(square), nonnegative(columns.rightCols(columns.cols() - n), target);
  else
    x = nonnegative(columns, target);
  ArmaxNoise result{x.head(n).cwiseProduct(square), x.segment(n, n).cwiseProduct(square)};
  if (n == 1 && A.size() == 3) result.Q(0) += x(2) * square(0);
  return result;
}

ArmaxFit in_levels(const ArmaxFit& fit) {
  if (!fit.order.differences) return fit;
  const Index n = fit.theta.rows(), na = fit.order.state_lags, nb = fit.order.input_lags, m = std::ssize(fit.delays);
  ArmaxFit levels = fit;
  levels.order.differences = false;
  levels.order.intercept = false;
  levels.order.state_lags = na + 1;
  if (m > 0) levels.order.input_lags = nb + 1;
  const Index noise = n * fit.order.noise_lags, from = n * (na + 1), q = fit.theta.cols() + noise;
  // (1 - q^-1) A(q), (1 - q^-1) B(q): each row of [theta C] times M, plus an identity.
  MatrixXd M = MatrixXd::Zero(q, from + m * (nb + 1) + noise);
  M.topLeftCorner(n * na, n * na).setIdentity();
  M.block(0, n, n * na, n * na) -= MatrixXd::Identity(n * na, n * na);
  for (Index i = 0; i < m; ++i) {
    M.block(n * na + i * nb, from + i * (nb + 1), nb, nb).setIdentity();
    M.block(n * na + i * nb, from + i * (nb + 1) + 1, nb, nb) -= MatrixXd::Identity(nb, nb);
  }
  M.bottomRightCorner(noise, noise).setIdentity();
  levels.theta = fit.theta * M.topLeftCorner(fit.theta.cols(), M.cols() - noise);
  levels.theta.leftCols(n) += MatrixXd::Identity(n, n);
  levels.covariance.resize(n * M.cols(), n * M.cols());
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      levels.covariance.block(i * M.cols(), j * M.cols(), M.cols(), M.cols()) =
          M.transpose() * fit.covariance.block(i * q, j * q, q, q) * M;
  return levels;
}

}  // namespace modebank
