#include <algorithm>
#include <cmath>

#include "ident/base/covariance.hpp"
#include "ident/base/linalg.hpp"
#include "ident/lag/linear_stage.hpp"

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

/// Least squares for C(q) e = w + A(q) v, the target last, in units of the errors `sd`, so that no state's unit counts.
/// Columns: R, Q, the force of a second-order motion, a wandering level, Q beside the diagonal.
MatrixXd balance_of(const ArmaxFit& fit, const VectorXd& sd) {
  const Index n = fit.theta.rows();
  const MatrixXd one = MatrixXd::Identity(n, n), unit = sd.cwiseInverse().asDiagonal();
  Polynomial A{one}, C{one};
  for (Index j = 0; j < fit.order.state_lags; ++j)
    A.push_back(-unit * fit.theta.middleCols(j * n, n) * sd.asDiagonal());
  for (Index j = 0; j < fit.order.noise_lags; ++j) C.push_back(unit * fit.C.middleCols(j * n, n) * sd.asDiagonal());
  const Index K = static_cast<Index>(std::max(A.size() + 1, C.size())) + 1;
  const auto taken = [&](const Polynomial& M) { return fit.order.differences ? times(M, -1.0) : M; };
  MatrixXd columns(K * n * n, 0);
  const auto add = [&](const Polynomial& M, const MatrixXd& V) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols(1) = autocovariances(M, V, K);
  };
  const auto add_diagonal = [&](const Polynomial& M) {
    for (Index i = 0; i < n; ++i) add(M, VectorXd::Unit(n, i).asDiagonal());
  };
  add_diagonal(taken(A));
  add_diagonal(taken({one}));
  // Force noise that is held between samples moves the position by an MA(1) with this root.
  if (n == 1 && A.size() == 3) add_diagonal(taken(times({one}, 1.0 / (2.0 + std::sqrt(3.0)))));
  if (fit.order.differences) add_diagonal(A);
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j)
      for (const double sign : {1.0, -1.0})
        add(taken({one}), sign * (one.col(i) * one.row(j) + one.col(j) * one.row(i)));
  add(C, unit * fit.S * unit);
  return columns;
}

/// Standard errors of R, by shifts along each root of the covariance of theta and C. R may turn negative, so that the
/// errors of an R at or near zero are those of its estimate before the bound. The other shapes are those in use.
VectorXd errors_of_R(const ArmaxFit& fit, const VectorXd& sd, const VectorXd& x) {
  const Index n = fit.theta.rows(), P = fit.theta.cols();
  std::vector<Index> used;
  for (Index j = 0; j < x.size(); ++j)
    if (j < n || x(j) > 0.0) used.push_back(j);
  const auto R_at = [&](const VectorXd& shift) {
    const MatrixXd by = shift.reshaped<Eigen::RowMajor>(n, shift.size() / n);
    ArmaxFit shifted = fit;
    shifted.theta += by.leftCols(P);
    shifted.C += by.rightCols(by.cols() - P);
    const MatrixXd balance = balance_of(shifted, sd);
    return VectorXd(solve_least_squares(balance(Eigen::all, used), balance.rightCols(1)).head(n));
  };
  VectorXd square = 2.0 / static_cast<double>(fit.rows) * x.head(n).cwiseAbs2();  // by that of the errors' variance
  const MatrixXd root = covariance_root(fit.covariance);
  for (const auto& shift : root.colwise()) square += (R_at(shift) - R_at(-shift)).cwiseAbs2() / 4.0;
  return square.cwiseSqrt();
}

}  // namespace

NoiseVariances noise_variances(const ArmaxFit& fit, const std::optional<VectorXd>& stated_R) {
  const Index n = fit.theta.rows();
  const VectorXd sd = fit.S.diagonal().cwiseSqrt(), square = sd.cwiseAbs2();
  const MatrixXd balance = balance_of(fit, sd);
  const Index held = stated_R ? n : 0, found = balance.cols() - 1 - held;
  VectorXd x(held + found);
  if (stated_R) x.head(n) = stated_R->cwiseQuotient(square);
  x.tail(found) = nonnegative_least_squares(balance.middleCols(held, found),
                                            balance.rightCols(1) - balance.leftCols(held) * x.head(held));
  NoiseVariances result{x.head(n).cwiseProduct(square), x.segment(n, n).cwiseProduct(square), VectorXd::Zero(n)};
  if (n == 1 && fit.order.state_lags == 2) result.Q(0) += x(2) * square(0);
  if (!stated_R) result.R_error = errors_of_R(fit, sd, x).cwiseProduct(square);
  return result;
}

}  // namespace modebank
