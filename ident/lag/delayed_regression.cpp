#include "ident/lag/delayed_regression.hpp"

#include "ident/base/linalg.hpp"

namespace modebank {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd centred(const MatrixXd& values, const VectorXd& weights) {
  const VectorXd mean = values * weights / weights.sum();
  return values.colwise() - mean;
}

MatrixXd regress_rows(const MatrixXd& X, const MatrixXd& Y, const VectorXd& weights) {
  constexpr double collinear = 1e-10;
  const MatrixXd XW = X * weights.asDiagonal();
  const SymmetricEigen gram = symmetric_eigen(XW * X.transpose());
  const double floor = collinear * gram.values.maxCoeff();
  const VectorXd inverse = (gram.values.array() > floor).select(gram.values.cwiseInverse(), 0.0);
  return (Y * XW.transpose()) * gram.vectors * inverse.asDiagonal() * gram.vectors.transpose();
}

}  // namespace modebank
