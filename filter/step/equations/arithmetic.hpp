#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "filter/step/equations/bounds.hpp"

/// Products and factorisations of small matrices without allocation. Eigen sums in different orders for fixed and
/// dynamic sizes. Here the order of summation is fixed, so both give the same bits.
namespace modebank::small {

using Eigen::Index;

/// A number of rows or columns that matter. Fixed sizes take all, so that loops have constant lengths.
template <int N>
constexpr Index or_all(Index count) {
  return N == Eigen::Dynamic ? count : N;
}

/// out = a b'. Only the first `seen` columns of b are nonzero. Requires seen >= 1; `out` must not alias.
template <class Out, class A, class B>
[[gnu::always_inline]] inline void multiply_transposed(Out& out, const A& a, const B& b, Index seen) {
  for (Index j = 0; j < b.rows(); ++j)
    for (Index i = 0; i < a.rows(); ++i) {
      double sum = a(i, 0) * b(j, 0);
      for (Index k = 1; k < seen; ++k) sum += a(i, k) * b(j, k);
      out(i, j) = sum;
    }
}

/// out = a b. Rows i >= `full` of `a` are shifts: row i is e_{i - full}'. b is zero outside its first `inner` rows and
/// columns. Only the first `inner` columns of `out` are written. The bits equal those of `multiply` if b is finite.
/// With full = a.rows(), `a` may be any matrix.
template <class Out, class A, class B>
[[gnu::always_inline]] inline void multiply_shifting(Out& out, const A& a, const B& b, Index full, Index inner) {
  for (Index j = 0; j < std::min(inner, b.cols()); ++j) {
    for (Index i = 0; i < full; ++i) {
      double sum = a(i, 0) * b(0, j);
      for (Index k = 1; k < inner; ++k) sum += a(i, k) * b(k, j);
      out(i, j) = sum;
    }
    for (Index i = full; i < a.rows(); ++i) out(i, j) = b(i - full, j);
  }
}

/// out = a b. Requires an inner size >= 1; `out` must not alias.
template <class Out, class A, class B>
[[gnu::always_inline]] inline void multiply(Out& out, const A& a, const B& b) {
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < a.rows(); ++i) {
      double sum = a(i, 0) * b(0, j);
      for (Index k = 1; k < a.cols(); ++k) sum += a(i, k) * b(k, j);
      out(i, j) = sum;
    }
}

/// out += a b'. b is as in multiply_shifting. The columns of `a` from `inner` on are zero. The product must be
/// symmetric (see add_symmetric_product).
template <class Out, class A, class B>
[[gnu::always_inline]] inline void add_symmetric_product_shifting(Out& out, const A& a, const B& b, Index full,
                                                                  Index inner) {
  const Index rows = std::min(a.rows(), inner + full);
  for (Index j = 0; j < rows; ++j)
    for (Index i = j; i < rows; ++i) {
      double sum = 0.0;
      if (j >= full) {
        sum = a(i, j - full);
      } else {
        sum = a(i, 0) * b(j, 0);
        for (Index k = 1; k < inner; ++k) sum += a(i, k) * b(j, k);
      }
      out(i, j) += sum;
      if (i != j) out(j, i) = out(i, j);
    }
}

/// out = a b. `a` differs from the identity only in its first `seen` columns. The bits equal those of `multiply` if b
/// is finite. With seen = a.cols(), `a` may be any matrix.
template <class Out, class A, class B>
[[gnu::always_inline]] inline void multiply_seeing(Out& out, const A& a, const B& b, Index seen) {
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < a.rows(); ++i) {
      double sum = a(i, 0) * b(0, j);
      for (Index k = 1; k < seen; ++k) sum += a(i, k) * b(k, j);
      out(i, j) = i < seen ? sum : sum + b(i, j);
    }
}

/// out += a b', with `a` and b as in multiply_seeing. The product must be symmetric (see add_symmetric_product).
template <class Out, class A, class B>
[[gnu::always_inline]] inline void add_symmetric_product_seeing(Out& out, const A& a, const B& b, Index seen) {
  for (Index j = 0; j < b.rows(); ++j)
    for (Index i = j; i < a.rows(); ++i) {
      double sum = a(i, 0) * b(j, 0);
      for (Index k = 1; k < seen; ++k) sum += a(i, k) * b(j, k);
      out(i, j) += j < seen ? sum : sum + a(i, j);
      if (i != j) out(j, i) = out(i, j);
    }
}

/// out += a b', for a product that is symmetric in theory. The lower triangle is computed and mirrored, so `out` is
/// exactly symmetric.
template <class Out, class A, class B>
void add_symmetric_product(Out& out, const A& a, const B& b) {
  add_symmetric_product_shifting(out, a, b, b.rows(), a.cols());
}

/// out += weight (P + d d'); all matrices are symmetric.
template <class Out, class Matrix, class D>
void add_about_mean(Out& out, double weight, const Matrix& P, const D& d) {
  for (Index j = 0; j < d.size(); ++j)
    for (Index i = j; i < d.size(); ++i) {
      out(i, j) += weight * (P(i, j) + d(i) * d(j));
      if (i != j) out(j, i) = out(i, j);
    }
}

/// Root-free Cholesky factorisation S = L D L', L unit lower triangular.
template <int Size>
struct Ldl {
  Eigen::Matrix<double, Size, Size> L;       ///< only the strictly lower part is used
  Eigen::Matrix<double, Size, 1> D;          ///< pivots, all positive
  Eigen::Matrix<double, Size, 1> D_inverse;  ///< 1 / D

  explicit Ldl(Index size) : L(size, size), D(size), D_inverse(size) {}

  template <class Matrix>
  void factorise(const Matrix& S) {
    for (Index j = 0; j < D.size(); ++j) {
      double pivot = S(j, j);
      for (Index k = 0; k < j; ++k) pivot -= L(j, k) * L(j, k) * D(k);
      D(j) = std::max({pivot, relative_pivot_floor * std::abs(S(j, j)), least_variance});
      D_inverse(j) = 1.0 / D(j);
      for (Index i = j + 1; i < D.size(); ++i) {
        double sum = S(i, j);
        for (Index k = 0; k < j; ++k) sum -= L(i, k) * L(j, k) * D(k);
        L(i, j) = sum * D_inverse(j);
      }
    }
  }

  /// v := L^-1 v: subtracts from each component its prediction from earlier components. The remainder has variance D.
  template <class Vector>
  void decorrelate(Vector&& v) const {
    for (Index i = 1; i < D.size(); ++i)
      for (Index k = 0; k < i; ++k) v(i) -= L(i, k) * v(k);
  }

  /// v := S^-1 v.
  template <class Vector>
  void solve(Vector&& v) const {
    decorrelate(v);
    for (Index i = D.size() - 1; i >= 0; --i) {
      v(i) *= D_inverse(i);
      for (Index k = i + 1; k < D.size(); ++k) v(i) -= L(k, i) * v(k);
    }
  }

  /// v' S^-1 v for a v that `decorrelate` has changed.
  template <class Vector>
  double squared_distance(const Vector& v) const {
    double sum = 0.0;
    for (Index i = 0; i < D.size(); ++i) sum += v(i) * v(i) * D_inverse(i);
    return sum;
  }

  double log_determinant() const {
    double sum = 0.0;
    for (Index i = 0; i < D.size(); ++i) sum += std::log(D(i));
    return sum;
  }
};

}  // namespace modebank::small
