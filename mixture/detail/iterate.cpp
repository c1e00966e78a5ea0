#include "mixture/detail/iterate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "ident/base/interruption.hpp"
#include "ident/base/linalg.hpp"
#include "mixture/detail/step.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Components of smaller weight are about to vanish. Their logarithms would mislead the extrapolation of the other
/// components.
constexpr double least_weight = 1e-9;

/// Safety factor on the estimated remaining gain of EM. A climb ends early only if even this factor times the estimate
/// is too small.
constexpr double margin = 10.0;

/// A mixture as an unconstrained vector: logarithms of the weights, and Cholesky factors with logarithms on the
/// diagonal. `scale` has the size of one unit of each entry: the square root of the complete data's Fisher information.
/// Conditional standard deviations are used in place of a full whitening.
struct Coordinates {
  Eigen::VectorXd values, scale;
};

std::optional<Coordinates> coordinates_of(const GaussianMixture& mixture) {
  const Index K = mixture.components(), F = mixture.features();
  const bool diagonal = mixture.type == CovarianceType::diagonal;
  const Index per_component = 1 + F + (diagonal ? F : F * (F + 1) / 2);
  Coordinates result{Eigen::VectorXd(K * per_component + 1), Eigen::VectorXd(K * per_component + 1)};
  Index at = 0;
  const auto put = [&](double value, double scale) {
    result.values(at) = value;
    result.scale(at++) = scale;
  };
  for (Index k = 0; k < K; ++k) {
    const double weight = mixture.weights(k), root = std::sqrt(weight);
    const Cholesky cholesky(mixture.covariances[static_cast<std::size_t>(k)]);
    if (weight < least_weight || !cholesky.definite()) return {};
    const Eigen::MatrixXd L = cholesky.L();
    put(std::log(weight), root);
    for (Index i = 0; i < F; ++i) put(mixture.means(i, k), root / L(i, i));
    for (Index i = 0; i < F; ++i) {
      put(std::log(L(i, i)), std::sqrt(2.0) * root);
      for (Index j = 0; j < (diagonal ? 0 : i); ++j) put(L(i, j), root / L(i, i));
    }
  }
  const double noise = mixture.noise.present() ? mixture.noise.weight : 1.0;
  if (noise < least_weight) return {};
  put(std::log(noise), mixture.noise.present() ? std::sqrt(noise) : 0.0);
  return result;
}

/// A mixture of the points cannot have larger logarithms or coordinates (in units of a point's error).
constexpr double largest_logarithm = 300.0, largest_coordinate_in_errors = 1e8;

/// Inverse of the mapping to coordinates. `pattern` gives the covariance type and the noise component. Empty if an
/// entry is out of range or NaN.
std::optional<GaussianMixture> mixture_of(const Eigen::VectorXd& values, const GaussianMixture& pattern,
                                          const EmOptions& options) {
  if (!(values.array().abs().maxCoeff() < largest_coordinate_in_errors)) return {};
  bool usable = true;
  const auto exponential = [&](double logarithm) {
    usable = usable && std::abs(logarithm) < largest_logarithm;
    return std::exp(logarithm);
  };
  const Index K = pattern.components(), F = pattern.features();
  const bool diagonal = pattern.type == CovarianceType::diagonal;
  GaussianMixture result = pattern;
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(F, F);
  Index at = 0;
  for (Index k = 0; k < K; ++k) {
    result.weights(k) = exponential(values(at++));
    for (Index i = 0; i < F; ++i) result.means(i, k) = values(at++);
    for (Index i = 0; i < F; ++i) {
      L(i, i) = exponential(values(at++));
      for (Index j = 0; j < (diagonal ? 0 : i); ++j) L(i, j) = values(at++);
    }
    if (!usable) return {};
    Eigen::MatrixXd& covariance = result.covariances[static_cast<std::size_t>(k)];
    covariance.noalias() = L * L.transpose();
    raise_to_floor(covariance, options.covariance_floor, options.covariance);
  }
  const double noise = pattern.noise.present() ? exponential(values(at)) : 0.0;
  if (!usable) return {};
  const double total = result.weights.sum() + noise;
  result.weights /= total;
  if (pattern.noise.present()) result.noise.weight = noise / total;
  return result;
}

/// Squared extrapolation from two successive EM steps: SQUAREM with step length S3 (Varadhan & Roland 2008, Scand. J.
/// Stat. 35, section 6). As in the paper, the longest allowed step grows after a step of that length. It shrinks if the
/// likelihood falls.
class Extrapolation {
 public:
  void forget() { before_.reset(); }
  /// Estimated distance to the limit of EM, divided by the length of its last but one step. The estimate assumes that
  /// steps shrink by the factor 1 - 1 / steps_left. Empty if the latest call of `next` could not estimate it.
  std::optional<double> steps_left() const { return steps_left_; }
  void shorten() {
    forget();
    longest_ = std::max(shortest, longest_ / growth);
  }

  /// Records an EM step from `from` to `to`. After two such steps in a row it returns the extrapolated point.
  std::optional<Eigen::VectorXd> next(const std::optional<Coordinates>& from, const std::optional<Coordinates>& to) {
    const std::optional<Coordinates> before = std::exchange(before_, from);
    steps_left_.reset();
    if (!from || !to) forget();
    if (!before || !from || !to) return {};
    const Eigen::VectorXd step = from->values - before->values, bend = to->values - from->values - step;
    const double size = before->scale.cwiseProduct(step).norm() / before->scale.cwiseProduct(bend).norm();
    steps_left_ = std::max(1.0, size);
    if (!(size > 1.0)) return {};  // no extrapolation: EM itself makes a step of this length
    const double length = std::min(size, longest_);
    if (length == longest_) longest_ *= growth;
    forget();
    return before->values + 2.0 * length * step + length * length * bend;
  }

 private:
  static constexpr double growth = 2.0, shortest = 2.0;
  std::optional<Coordinates> before_;
  std::optional<double> steps_left_;
  double longest_ = 4.0;
};

}  // namespace

EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options, Steps steps,
                 double hopeless_below) {
  const double least_gain = options.tolerance * points.total_weight();
  EmResult result;
  result.log_likelihood = -std::numeric_limits<double>::infinity();
  Extrapolation extrapolation;
  GaussianMixture trial = std::move(start);
  std::optional<GaussianMixture> plain;  // the plain EM step; set if `trial` is extrapolated
  while (true) {
    interruption_point();
    const bool last = result.iterations == options.max_iterations;
    const MixtureMoments moments = last ? measure(points, trial) : expect(points, trial);
    const double gain = moments.log_likelihood - result.log_likelihood;
    if (plain && !(gain >= 0.0)) {
      trial = std::move(*plain);
      plain.reset();
      extrapolation.shorten();
      continue;
    }
    result.log_likelihood = moments.log_likelihood;
    // Only the gain of a plain EM step shows how near the optimum is.
    result.converged = !plain && gain < least_gain;
    if (result.converged || last) break;
    if (steps == Steps::extrapolated) result.mixture = trial;
    result.floor_active = maximise(moments, options.covariance_floor, trial);
    ++result.iterations;
    plain.reset();
    if (steps == Steps::plain) continue;
    const auto next = extrapolation.next(coordinates_of(result.mixture), coordinates_of(trial));
    // If steps shrink as one geometric series, the remaining gain is at most half of gain * steps. If several series
    // act together, it is larger than the fastest series suggests.
    if (const auto left = extrapolation.steps_left();
        left && result.log_likelihood + margin * gain * *left < hopeless_below)
      return result;
    std::optional<GaussianMixture> mixture = next ? mixture_of(*next, trial, options) : std::nullopt;
    if (!mixture) continue;
    plain = std::exchange(trial, std::move(*mixture));
  }
  result.mixture = std::move(trial);
  return result;
}

}  // namespace modebank
