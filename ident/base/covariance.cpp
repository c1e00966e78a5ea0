#include "ident/base/covariance.hpp"

#include "ident/base/linalg.hpp"

namespace modebank {

bool is_covariance(const Eigen::MatrixXd& M) {
  constexpr double rounding = 1e-9;
  if (M.rows() != M.cols() || !M.allFinite() || (M.diagonal().array() < 0.0).any()) return false;
  // The matrix in units in which every standard deviation is 1. A row without variance must be zero.
  const Eigen::VectorXd sd = M.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = (sd.array() > 0.0).select(sd.cwiseInverse(), 0.0);
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    if (sd(i) == 0.0 && !(M.row(i).isZero(0.0) && M.col(i).isZero(0.0))) return false;
  const Eigen::MatrixXd correlation = scale.asDiagonal() * M * scale.asDiagonal();
  if (!correlation.allFinite() || !(correlation - correlation.transpose()).isZero(rounding)) return false;
  return Cholesky(correlation + rounding * Eigen::MatrixXd::Identity(M.rows(), M.cols())).definite();
}

Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& M) {
  const Eigen::VectorXd sd = M.diagonal().cwiseSqrt();  // scaled first, because parameters have different units
  const Eigen::VectorXd inverse = (sd.array() > 0.0).select(sd.cwiseInverse(), 0.0);
  const SymmetricEigen axes = symmetric_eigen(inverse.asDiagonal() * M * inverse.asDiagonal());
  const Eigen::Index rank = (axes.values.array() > 0.0).count();  // values increase, so positive values come last
  return sd.asDiagonal() * axes.vectors.rightCols(rank) * axes.values.tail(rank).cwiseSqrt().asDiagonal();
}

}  // namespace modebank
