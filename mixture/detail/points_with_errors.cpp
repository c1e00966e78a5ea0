// EM on points with error covariances (extreme deconvolution: Bovy, Hogg & Roweis 2011), one point at a time.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mixture/detail/kernels/kernels.hpp"

namespace modebank::em {
namespace {

/// Smallest usable pivot of T, as a share of its diagonal. With a smaller pivot, an error is so large in one direction
/// that rounding hides the other directions. The point then counts as unknown in those directions, too.
constexpr double smallest_pivot_ratio = 1e-12;
/// Replaces squared distances that are larger or NaN, so that no density is NaN.
constexpr double largest_error_distance = 2e300;

Index moments_of(Index features, bool diagonal) { return diagonal ? features : features * (features + 1) / 2; }

/// One point x with error covariance S, relative to one component at a time. Coordinates are scaled so that the
/// component's covariance is I. The point's covariance is then T = I + W S W'. All eigenvalues of T are at least one,
/// so its factorisation cannot break down. With y = W (x - mu) and z = T^-1 y, the error-free point has mean z and
/// covariance I - T^-1 (eq. 15).
class PointWithError {
 public:
  PointWithError(Index features, bool diagonal) : diagonal_(diagonal), x_(features), S_(features, features) {}

  void read(const Block& block, Index point) {
    const double* error = block.errors + point;
    for (Index i = 0; i < x_.size(); ++i) {
      x_(i) = block.points[i * block_size + point];
      for (Index j = 0; j <= i; ++j, error += block_size) S_(i, j) = S_(j, i) = *error;
    }
  }

  /// y' T^-1 y + log |T|, which is minus twice the exponent of the density. `W` is in the layout Packing::whole.
  double exponent(const double* mean, const double* W) {
    const Index n = x_.size();
    const Eigen::Map<const Eigen::MatrixXd> whitening(W, n, n);
    y_.noalias() = whitening.lazyProduct(x_ - Eigen::Map<const Eigen::VectorXd>(mean, n));
    half_.noalias() = whitening.lazyProduct(S_);
    T_.noalias() = half_.lazyProduct(whitening.transpose());
    T_.diagonal().array() += 1.0;
    factor();
    y_ = inverse_.lazyProduct(y_).eval();
    scaled_ = y_.cwiseQuotient(pivots_);
    const double distance = y_.dot(scaled_);
    return (distance < largest_error_distance ? distance : largest_error_distance) + pivots_.array().log().sum();
  }

  /// Computes z, then z z' + I - T^-1 (lower triangle by rows, or the diagonal). Both are for the component of the
  /// latest call of `exponent`.
  void expect(double* z, double* second) {
    const Index n = x_.size();
    Eigen::Map<Eigen::VectorXd> expected(z, n);
    expected.noalias() = inverse_.transpose().lazyProduct(scaled_);
    half_.noalias() = pivots_.cwiseInverse().asDiagonal() * inverse_;
    T_.noalias() = inverse_.transpose().lazyProduct(half_);
    for (Index i = 0; i < n; ++i)
      for (Index j = diagonal_ ? i : 0; j <= i; ++j)
        *second++ = expected(i) * expected(j) + (i == j ? 1.0 : 0.0) - T_(i, j);
  }

 private:
  /// Factors T = L D L' with unit lower triangular L; gives D and the inverse of L.
  void factor() {
    const Index n = x_.size();
    const Eigen::VectorXd least = (smallest_pivot_ratio * T_.diagonal()).cwiseMax(1.0);
    pivots_.resize(n);
    inverse_.setIdentity(n, n);
    for (Index j = 0; j < n; ++j) {
      pivots_(j) = std::max(T_(j, j), least(j));
      for (Index i = j + 1; i < n; ++i) {
        const double below = T_(i, j) / pivots_(j);
        for (Index l = j + 1; l <= i; ++l) T_(i, l) -= below * T_(l, j);
        inverse_.row(i).head(j + 1) -= below * inverse_.row(j).head(j + 1);
      }
    }
  }

  bool diagonal_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd S_, half_, T_, inverse_;
  Eigen::VectorXd y_, pivots_, scaled_;
};

enum class Sums { none, likelihood, all };

template <Sums sums>
void pass(const Components& components, const Block& block, const Scratch& scratch) {
  const Index features = components.features, K = components.count;
  const Index moments = moments_of(features, components.diagonal), entries = 1 + features + moments;
  PointWithError point(features, components.diagonal);
  Eigen::MatrixXd expected(features + moments, K);
  for (Index i = 0; i < block_size; ++i) {
    point.read(block, i);
    const auto relative = [&](Index row) -> double& { return scratch.relative[row * block_size + i]; };
    double largest = block.noise ? block.noise[i] : -std::numeric_limits<double>::infinity();
    if (block.noise) relative(K) = block.noise[i];
    for (Index k = 0; k < K; ++k) {
      relative(k) = components.log_constants[k] -
                    0.5 * point.exponent(components.means + k * features, components.whitening + k * components.stride);
      largest = std::max(largest, relative(k));
      if (sums == Sums::all) point.expect(expected.col(k).data(), expected.col(k).data() + features);
    }
    double sum = 0.0;
    for (Index k = 0; k < K + (block.noise ? 1 : 0); ++k) sum += relative(k) = std::exp(relative(k) - largest);
    scratch.sum[i] = sum;
    scratch.log_density[i] = largest + std::log(sum);
    if (sums == Sums::none) continue;
    const double scale = block.weights[i] / sum;
    scratch.lanes[0] += block.weights[i] * scratch.log_density[i];
    if (block.noise) scratch.lanes[lanes()] += scale * relative(K);
    double* to = scratch.lanes + 2 * lanes();
    for (Index k = 0; sums == Sums::all && k < K; ++k) {
      const double share = scale * relative(k);
      for (Index entry = 0; entry < entries; ++entry, to += lanes())
        *to += entry == 0 ? share : share * expected(entry - 1, k);
    }
  }
}

}  // namespace

Kernels error_kernels(int features, bool diagonal) {
  Kernels kernels;
  kernels.packing = Packing::whole;
  kernels.entries = 1 + features + moments_of(features, diagonal);
  kernels.evaluate = pass<Sums::none>;
  kernels.measure = pass<Sums::likelihood>;
  kernels.accumulate = pass<Sums::all>;
  return kernels;
}

}  // namespace modebank::em
