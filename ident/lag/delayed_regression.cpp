#include "ident/lag/delayed_regression.hpp"

#include <Eigen/Eigenvalues>

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
  const Eigen::SelfAdjointEigenSolver<MatrixXd> gram(XW * X.transpose());
  const VectorXd& eigenvalues = gram.eigenvalues();
  const double floor = collinear * eigenvalues.maxCoeff();
  const VectorXd inverse = (eigenvalues.array() > floor).select(eigenvalues.cwiseInverse(), 0.0);
  return (Y * XW.transpose()) * gram.eigenvectors() * inverse.asDiagonal() * gram.eigenvectors().transpose();
}

}  // namespace modebank
