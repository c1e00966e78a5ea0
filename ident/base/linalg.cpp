#include "ident/base/linalg.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <vector>

namespace modebank {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ThinSvd thin_svd(const MatrixXd& X) {
  const Eigen::JacobiSVD<MatrixXd> svd(X, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

VectorXd solve_least_squares(const MatrixXd& A, const VectorXd& b) {
  return Eigen::JacobiSVD<MatrixXd>(A, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(b);
}

VectorXd nonnegative_least_squares(const MatrixXd& A, const VectorXd& b) {
  VectorXd x = VectorXd::Zero(A.cols());
  std::vector<Eigen::Index> used;
  const double tolerance = 1e-12 * (A.transpose() * b).cwiseAbs().maxCoeff();
  for (Eigen::Index round = 0; round < 3 * A.cols(); ++round) {
    VectorXd gradient = A.transpose() * (b - A * x);
    for (const Eigen::Index j : used) gradient(j) = 0.0;
    Eigen::Index best = 0;
    if (A.cols() == 0 || !(gradient.maxCoeff(&best) > tolerance)) break;
    used.push_back(best);
    while (!used.empty()) {
      const VectorXd z = solve_least_squares(A(Eigen::all, used), b), at = x(used);
      const double step = (z.array() <= 0.0).select(at.array() / (at - z).array(), 1.0).minCoeff();
      x(used) += step * (z - at);
      if (step == 1.0) break;
      std::erase_if(used, [&](Eigen::Index j) { return !(x(j) > 1e-14 * x.maxCoeff()) && ((x(j) = 0.0), true); });
    }
  }
  return x;
}

VectorXd singular_values(const MatrixXd& square) {
  constexpr Eigen::Index large = 24;  // Jacobi rotations take eight times as long with 60 columns
  if (square.cols() >= large) return Eigen::BDCSVD<MatrixXd>(square).singularValues();
  // a square matrix needs no QR preconditioner
  return Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner>(square).singularValues();
}

ThinQr thin_qr(const MatrixXd& X) {
  const Eigen::HouseholderQR<MatrixXd> qr(X);
  ThinQr result;
  result.Q = qr.householderQ() * MatrixXd::Identity(X.rows(), X.cols());
  result.R = qr.matrixQR().topRows(X.cols()).triangularView<Eigen::Upper>();
  return result;
}

MatrixXd qr_triangle(const MatrixXd& X) {
  return Eigen::HouseholderQR<MatrixXd>(X).matrixQR().topRows(X.cols()).triangularView<Eigen::Upper>();
}

MatrixXd divide_by_triangle(MatrixXd A, const MatrixXd& R) {
  R.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(A);
  return A;
}

MatrixXd solve_transposed_triangle(const MatrixXd& R, const MatrixXd& B) {
  return R.transpose().triangularView<Eigen::Lower>().solve(B);
}

SymmetricEigen symmetric_eigen(const MatrixXd& M) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& M) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(M, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXcd eigenvalues(const MatrixXd& square) { return square.eigenvalues(); }

void Cholesky::factorise(const MatrixXd& M) { factor_.compute(M); }

double Cholesky::rcond() const { return factor_.rcond(); }

MatrixXd Cholesky::L() const { return factor_.matrixL(); }

MatrixXd Cholesky::inverse() const { return factor_.solve(MatrixXd::Identity(factor_.rows(), factor_.cols())); }

MatrixXd Cholesky::inverse_root() const {
  return factor_.matrixU().solve(MatrixXd::Identity(factor_.rows(), factor_.cols()));
}

VectorXd Cholesky::solve(const VectorXd& b) const { return factor_.solve(b); }

VectorXd Cholesky::whiten(const VectorXd& b) const { return factor_.matrixL().solve(b); }

MatrixXd Cholesky::whiten(const MatrixXd& B) const { return factor_.matrixL().solve(B); }

std::optional<MatrixXd> definite_inverse(const MatrixXd& M) {
  const Cholesky factor(M);
  // The factorisation stops at the first failing pivot, so solving with it would give a wrong result.
  if (!factor.definite()) return std::nullopt;
  return factor.inverse();
}

double log_determinant(const MatrixXd& M) {
  return 2.0 * Eigen::LLT<MatrixXd>(M).matrixLLT().diagonal().array().log().sum();
}

VectorXd solve_semidefinite(const MatrixXd& M, const VectorXd& b) { return M.ldlt().solve(b); }

MatrixXd solve_semidefinite(const MatrixXd& M, const MatrixXd& B) { return M.ldlt().solve(B); }

VectorXd semidefinite_pivots(const MatrixXd& M) { return M.ldlt().vectorD(); }

PivotedLu::PivotedLu(const MatrixXd& M) : factor_(M) {}

bool PivotedLu::invertible() const { return factor_.isInvertible(); }

double PivotedLu::rcond() const { return factor_.rcond(); }

MatrixXd PivotedLu::inverse() const { return factor_.inverse(); }

VectorXd PivotedLu::solve(const VectorXd& b) const { return factor_.solve(b); }

MatrixXd PivotedLu::solve(const MatrixXd& B) const { return factor_.solve(B); }

}  // namespace modebank
