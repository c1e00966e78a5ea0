#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/step/equations/kalman.hpp"
#include "filter/step/truncated_normal.hpp"

/// Quantised measurements. A value in multiples of q only shows that C x + v lies in [y - q/2, y + q/2]. A mode
/// predicts the signal as N(C x, s). So the interval's probability is a difference of normal distribution functions,
/// and the signal's posterior is a truncated normal. Mean and variance of this posterior update the state by the Kalman
/// gain:
///   x <- x + K (E[C x + v | interval] - C x),   P <- P + K (Var[C x + v | interval] - s) K',   K = P C' / s.
/// For one signal these moments are exact. Several signals are processed one after another. After each of them, the
/// posterior is approximated by a Gaussian (assumed density filtering: Maybeck 1982, "Stochastic Models, Estimation and
/// Control", volume 2, chapter 12). A signal of quantum zero has exactly the recorded value.
namespace modebank {

/// Does the work of `observe` and `correct` (kalman.hpp) for quantised signals; call after `expect`. `sensor` has C,
/// diagonal R and the quanta. Stores the signals' innovations given the previous signals in `decorrelated`, and their
/// variances in `cholesky.D`. Other parts of the factor are overwritten.
template <int N, int NY, class Sensor, class Y>
void correct_intervals(const Sensor& sensor, const Y& y, KalmanStep<N, NY>& kalman, Gaussian<N>& posterior) {
  const Eigen::Index n = posterior.mean.size();
  small::multiply(kalman.innovation, sensor.C, kalman.predicted.mean);
  kalman.innovation = y - kalman.innovation;
  posterior = kalman.predicted;
  kalman.log_density = 0.0;
  for (Eigen::Index i = 0; i < kalman.innovation.size(); ++i) {
    double expected = 0.0, s = sensor.R(i, i);
    for (Eigen::Index a = 0; a < n; ++a) {
      double sum = 0.0;
      for (Eigen::Index b = 0; b < n; ++b) sum += posterior.covariance(a, b) * sensor.C(i, b);
      kalman.column(a) = sum;
      expected += sensor.C(i, a) * posterior.mean(a);
    }
    for (Eigen::Index a = 0; a < n; ++a) s += sensor.C(i, a) * kalman.column(a);
    s = std::max(s, least_variance);
    const double e = y(i) - expected;
    const SignalLikelihood said = signal_likelihood(e, s, sensor.quantum(i));
    const double step = said.mean / std::sqrt(s), shrink = (1.0 - said.variance) / s;
    for (Eigen::Index b = 0; b < n; ++b) {
      posterior.mean(b) += step * kalman.column(b);
      for (Eigen::Index a = b; a < n; ++a)
        posterior.covariance(b, a) = posterior.covariance(a, b) -= shrink * kalman.column(a) * kalman.column(b);
    }
    kalman.decorrelated(i) = e;
    kalman.cholesky.D(i) = s;
    kalman.signal_log_density(i) = said.log_density;
    kalman.second_moment(i) = said.mean * said.mean + said.variance;
    kalman.log_density += said.log_density;
  }
  if (!(kalman.log_density > lowest_log_density)) kalman.log_density = lowest_log_density;
  if (!is_finite(posterior)) posterior = kalman.predicted;  // a correction that overflows is ignored
  bound_variances(kalman.predicted, posterior);
}

/// The sums of one Kalman step for the noise scale (noise_scale.hpp). Call after correct_intervals. Each signal's e^2 /
/// s is replaced by its expectation given the interval.
struct IntervalSums {
  double share = 0.0, square = 0.0;
};

template <class Sensor, class Matrix, class Kalman>
IntervalSums interval_sums(const Sensor& sensor, const Matrix& P, const Kalman& kalman, double most) {
  IntervalSums sums;
  for (Eigen::Index i = 0; i < kalman.decorrelated.size(); ++i) {
    double variance = 0.0;
    for (Eigen::Index q = 0; q < P.cols(); ++q)
      for (Eigen::Index p = 0; p < P.rows(); ++p) variance += sensor.C(i, p) * P(p, q) * sensor.C(i, q);
    const double share = variance / kalman.cholesky.D(i);
    sums.share += share;
    sums.square += share * std::min(kalman.second_moment(i), most);
  }
  return sums;
}

}  // namespace modebank
