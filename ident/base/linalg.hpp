#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <optional>

/// Decompositions of dense matrices by Eigen, compiled once: a name for what each computes, and for a compiler one of
/// Eigen's heaviest parts less in every file that needs one. Matrices must be finite.
namespace modebank {

/// X = U diag(sigma) V' with as many columns as the smaller side of X has; sigma decreases.
struct ThinSvd {
  Eigen::MatrixXd U;
  Eigen::VectorXd sigma;
  Eigen::MatrixXd V;
};
ThinSvd thin_svd(const Eigen::MatrixXd& X);
/// The x of least norm among those that make |A x - b| least.
Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// Of a square matrix, decreasing.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& square);

/// X = Q R, Q with orthonormal columns and R upper triangular; X has at least as many rows as columns.
struct ThinQr {
  Eigen::MatrixXd Q;
  Eigen::MatrixXd R;
};
ThinQr thin_qr(const Eigen::MatrixXd& X);
/// R of X = Q R.
Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& X);
/// A R^-1 of an upper triangular R.
Eigen::MatrixXd divide_by_triangle(Eigen::MatrixXd A, const Eigen::MatrixXd& R);
/// R'^-1 B of an upper triangular R.
Eigen::MatrixXd solve_transposed_triangle(const Eigen::MatrixXd& R, const Eigen::MatrixXd& B);

/// M = V diag(values) V' of a symmetric matrix; values increase.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& M);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& M);

/// Of any square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& square);
/// The largest real part among the eigenvalues of a linear map on R^n that is known by its products M x alone. `start`
/// (n): a guess of its eigenvector. Restarted Arnoldi iteration (Spectra) to 1e-11 of the result; dense where the map
/// is small, or where that does not converge.
double largest_real_eigenvalue(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& product,
                               const Eigen::VectorXd& start);

/// Cholesky's factor of a symmetric positive definite matrix, M = L L'.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Eigen::MatrixXd& M) { factorise(M); }
  void factorise(const Eigen::MatrixXd& M);

  /// Whether M is positive definite; nothing else means anything where it is not.
  bool definite() const { return factor_.info() == Eigen::Success; }
  /// An estimate of the reciprocal condition number of M.
  double rcond() const;
  Eigen::MatrixXd L() const;
  Eigen::MatrixXd inverse() const;
  /// L'^-1: times its transpose it is the inverse of M.
  Eigen::MatrixXd inverse_root() const;
  /// M^-1 b.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// L^-1 b: what was distributed as N(0, M) is then as N(0, I).
  Eigen::VectorXd whiten(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& B) const;

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// Inverse of a symmetric positive definite matrix, by Cholesky's factor; empty where it is not definite.
std::optional<Eigen::MatrixXd> definite_inverse(const Eigen::MatrixXd& M);
/// Logarithm of the determinant of a symmetric positive definite matrix.
double log_determinant(const Eigen::MatrixXd& M);

/// M^-1 b of a symmetric matrix that is positive or negative semidefinite up to rounding, by the root-free factor M = L
/// D L' with pivoting.
Eigen::VectorXd solve_semidefinite(const Eigen::MatrixXd& M, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_semidefinite(const Eigen::MatrixXd& M, const Eigen::MatrixXd& B);
/// The diagonal of that D.
Eigen::VectorXd semidefinite_pivots(const Eigen::MatrixXd& M);

/// Gaussian elimination with full pivoting, for square matrices that may be singular.
class PivotedLu {
 public:
  explicit PivotedLu(const Eigen::MatrixXd& M);
  bool invertible() const;
  /// An estimate of the reciprocal condition number.
  double rcond() const;
  Eigen::MatrixXd inverse() const;
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

 private:
  Eigen::FullPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace modebank
