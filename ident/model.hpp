#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modebank {

/// Shape of the linear increment model x[k+1] = x[k] + A x[k] + B u[k] (+ c) + w[k] (Salvi et al. 2025, eq. 1).
/// theta is the row-major vec of [A B (c)]: row i of [A B (c)] predicts the increment of state i.
/// This header is the one place where that equation stands; fits, filters and simulation call it.
struct LinearStructure {
  Eigen::Index states = 1;  ///< n
  Eigen::Index inputs = 0;  ///< m
  bool intercept = false;   ///< whether c is estimated

  Eigen::Index regressors() const { return states + inputs + (intercept ? 1 : 0); }  ///< q, columns of [A B (c)]
  Eigen::Index parameters() const { return states * regressors(); }                  ///< p = n q
  /// "A", "B1", "B2", "c" for one state; "A11", "A12", "B11", ..., "c1" for several.
  std::vector<std::string> parameter_names() const;
  bool operator==(const LinearStructure&) const = default;
};

/// phi = [x; u; (1)], the q regressors of one transition.
template <class X, class U, class Phi>
void fill_regressor(const LinearStructure& s, const X& x, const U& u, Phi&& phi) {
  phi.head(s.states) = x;
  phi.segment(s.states, s.inputs) = u;
  if (s.intercept) phi(s.regressors() - 1) = typename std::decay_t<Phi>::Scalar(1);
}

/// next = x + A x + B u + c (must not alias x). Sums run in the same order for fixed and dynamic sizes, so every caller
/// gets the same numbers; nothing is allocated.
template <class MatrixA, class MatrixB, class VectorC, class X, class U, class Next>
void propagate(const MatrixA& A, const MatrixB& B, const VectorC& c, const X& x, const U& u, Next& next) {
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    auto increment = c(i);
    for (Eigen::Index j = 0; j < A.cols(); ++j) increment += A(i, j) * x(j);
    for (Eigen::Index j = 0; j < B.cols(); ++j) increment += B(i, j) * u(j);
    next(i) = x(i) + increment;
  }
}

/// The matrices of one parameter vector.
struct LinearModel {
  Eigen::MatrixXd A;  ///< n x n, increment form: the full form is I + A
  Eigen::MatrixXd B;  ///< n x m
  Eigen::VectorXd c;  ///< n, zero without intercept

  /// x[k+1] without noise.
  template <class X, class U>
  Eigen::VectorXd next(const X& x, const U& u) const {
    Eigen::VectorXd result(x.size());
    propagate(A, B, c, x, u, result);
    return result;
  }
  /// I + A, the matrix of the full form x[k+1] = (I + A) x[k] + ...
  Eigen::MatrixXd full_form() const { return A + Eigen::MatrixXd::Identity(A.rows(), A.cols()); }
};

LinearModel unpack(const LinearStructure& structure, const Eigen::VectorXd& theta);
Eigen::VectorXd pack(const LinearStructure& structure, const LinearModel& model);

}  // namespace modebank
