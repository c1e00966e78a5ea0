#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <optional>

/// Dense matrix decompositions by Eigen. Eigen's templates for decompositions are slow to compile, so this file
/// compiles them once. Matrices must be finite.
namespace modebank {

/// X = U diag(sigma) V' with min(rows, columns) singular values in decreasing order.
struct ThinSvd {
  Eigen::MatrixXd U;
  Eigen::VectorXd sigma;
  Eigen::MatrixXd V;
};
ThinSvd thin_svd(const Eigen::MatrixXd& X);
/// The x of minimum norm among all x that minimise |A x - b|.
Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// The x >= 0 that minimises |A x - b| (Lawson & Hanson 1974, section 23.3).
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// Singular values of a square matrix, in decreasing order.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& square);

/// X = Q R; Q has orthonormal columns, R is upper triangular. X has at least as many rows as columns.
struct ThinQr {
  Eigen::MatrixXd Q;
  Eigen::MatrixXd R;
};
ThinQr thin_qr(const Eigen::MatrixXd& X);
/// The factor R of X = Q R.
Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& X);
/// A R^-1 for an upper triangular R.
Eigen::MatrixXd divide_by_triangle(Eigen::MatrixXd A, const Eigen::MatrixXd& R);
/// R'^-1 B for an upper triangular R.
Eigen::MatrixXd solve_transposed_triangle(const Eigen::MatrixXd& R, const Eigen::MatrixXd& B);

/// M = V diag(values) V' of a symmetric matrix; values in increasing order.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& M);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& M);

/// Eigenvalues of any square matrix, unordered.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& square);

/// Cholesky factor of a symmetric positive definite matrix, M = L L'.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Eigen::MatrixXd& M) { factorise(M); }
  void factorise(const Eigen::MatrixXd& M);

  /// Whether M is positive definite. If it is not, the other members are invalid.
  bool definite() const { return factor_.info() == Eigen::Success; }
  /// An estimate of the reciprocal condition number of M.
  double rcond() const;
  Eigen::MatrixXd L() const;
  Eigen::MatrixXd inverse() const;
  /// L'^-1. This matrix times its transpose is the inverse of M.
  Eigen::MatrixXd inverse_root() const;
  /// M^-1 b.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// L^-1 b. It maps a sample of N(0, M) to a sample of N(0, I).
  Eigen::VectorXd whiten(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& B) const;

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// Inverse of a symmetric positive definite matrix by its Cholesky factor; empty if the matrix is not definite.
std::optional<Eigen::MatrixXd> definite_inverse(const Eigen::MatrixXd& M);
/// Logarithm of the determinant of a symmetric positive definite matrix.
double log_determinant(const Eigen::MatrixXd& M);

/// M^-1 b for a symmetric matrix that is positive or negative semidefinite up to rounding. Uses the root-free
/// factorisation M = L D L' with pivoting.
Eigen::VectorXd solve_semidefinite(const Eigen::MatrixXd& M, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_semidefinite(const Eigen::MatrixXd& M, const Eigen::MatrixXd& B);
/// The diagonal of D in the factorisation that solve_semidefinite uses.
Eigen::VectorXd semidefinite_pivots(const Eigen::MatrixXd& M);

/// LU decomposition with full pivoting, for square matrices that may be singular.
class PivotedLu {
 public:
  explicit PivotedLu(const Eigen::MatrixXd& M);
  bool invertible() const;
  /// An estimate of the reciprocal condition number of the matrix.
  double rcond() const;
  Eigen::MatrixXd inverse() const;
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

 private:
  Eigen::FullPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace modebank
