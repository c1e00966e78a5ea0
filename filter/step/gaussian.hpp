#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

/// Gaussians, products and factorisations of small matrices without allocation, and the limits that keep a filter's
/// arithmetic stable for any input.
namespace modebank {

/// Lower bound of mode probabilities after a measurement, before they are renormalised, so that every mode can recover.
inline constexpr double mode_probability_floor = 1e-12;
/// A mode with a smaller probability before a measurement is impossible (T forbids it). The filter skips such a mode.
inline constexpr double impossible_probability = 1e-100;
/// Upper bounds of variances and means in a diverging prediction, so that squares stay finite.
inline constexpr double largest_variance = 1e60, largest_mean = 1e30;
/// Smallest variance, used if S = 0. The standard deviation is 1e-20 in the signal's unit.
inline constexpr double least_variance = 1e-40;
/// Smallest pivot of a covariance, as a share of its diagonal entry. Smaller pivots are rounding errors.
inline constexpr double relative_pivot_floor = 1e-14;

/// Lower bound of log densities. NaN, from an overflow, has this value, too: a filter that failed at a sample is not
/// one that did not measure it.
inline constexpr double lowest_log_density = -1e300;
inline double measured_density(double value) { return value > lowest_log_density ? value : lowest_log_density; }

/// A measurement counts as missing if it is NaN, infinite, or at least this large.
inline constexpr double largest_measurement = 1e30;
inline bool is_missing(double y) { return !(std::abs(y) < largest_measurement); }

/// Number of missing entries in a measurement.
template <class Y>
Eigen::Index missing_entries(const Y& y) {
  return y.size() - (y.array().abs() < largest_measurement).count();
}

/// Eigen sums in different orders for fixed and dynamic sizes. Here the order of summation is fixed, so both give the
/// same bits.
namespace small {

using Eigen::Index;

/// out = a b. Requires an inner size >= 1; `out` must not alias.
template <class Out, class A, class B>
[[gnu::always_inline]] inline void multiply(Out&& out, const A& a, const B& b) {
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < a.rows(); ++i) {
      double sum = a(i, 0) * b(0, j);
      for (Index k = 1; k < a.cols(); ++k) sum += a(i, k) * b(k, j);
      out(i, j) = sum;
    }
}

/// out += a b', for a product that is symmetric in theory. The lower triangle is computed and mirrored, so `out` is
/// exactly symmetric.
template <class Out, class A, class B>
[[gnu::always_inline]] inline void add_symmetric_product(Out&& out, const A& a, const B& b) {
  for (Index j = 0; j < b.rows(); ++j)
    for (Index i = j; i < a.rows(); ++i) {
      double sum = a(i, 0) * b(j, 0);
      for (Index k = 1; k < a.cols(); ++k) sum += a(i, k) * b(j, k);
      out(i, j) += sum;
      if (i != j) out(j, i) = out(i, j);
    }
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

}  // namespace small

/// Mean and covariance of a state of size N, fixed or Eigen::Dynamic.
template <int N>
struct Gaussian {
  Eigen::Matrix<double, N, 1> mean;
  Eigen::Matrix<double, N, N> covariance;
  bool known = false;  ///< the covariance is zero, since an exact sensor measured all samples of the state

  explicit Gaussian(Eigen::Index size) : mean(size), covariance(size, size) {
    mean.setZero();
    covariance.setZero();
  }
};

/// Sets the correlations to zero, and each variance to variance(i).
template <class Matrix, class Variance>
void uncorrelate(Matrix&& P, Variance variance) {
  for (Eigen::Index j = 0; j < P.cols(); ++j)
    for (Eigen::Index i = 0; i < P.rows(); ++i) P(i, j) = i == j ? variance(i) : 0.0;
}

/// Repairs a prediction. Diverging values are scaled down. If variances differ by more than double precision, rounding
/// can make a covariance indefinite. The variances then stay, and the correlations are set to zero.
template <int N>
void make_usable(Gaussian<N>& g) {
  const auto variances = g.covariance.diagonal();
  if (variances.minCoeff() < 0.0) uncorrelate(g.covariance, [&](Eigen::Index i) { return std::abs(variances(i)); });
  const double largest = variances.maxCoeff(), mean = g.mean.cwiseAbs().maxCoeff();
  if (largest > largest_variance) g.covariance *= largest_variance / largest;
  if (mean > largest_mean) g.mean *= largest_mean / mean;
}

/// Rounding can make a variance negative if S is near singular (R = 0 and singular Q). The variances are then kept
/// within those before the measurement, which cannot enlarge them, and the correlations are set to zero.
template <int N>
void bound_variances(const Gaussian<N>& predicted, Gaussian<N>& posterior) {
  if ((posterior.covariance.diagonal().array() >= 0.0).all()) return;
  uncorrelate(posterior.covariance, [&](Eigen::Index i) {
    return std::clamp(posterior.covariance(i, i), 0.0, std::max(0.0, predicted.covariance(i, i)));
  });
}

}  // namespace modebank
