#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/step/equations/bounds.hpp"
#include "filter/step/equations/interval.hpp"
#include "filter/step/equations/model.hpp"

/// The scale s of the process noise, which a filter with adaptive noise learns within a run. Every mode's Q is
/// multiplied by s, because runs of the same motion differ in the size of their noise. s is a ratio of discounted sums,
/// similar to variance discounting in West & Harrison 1997, "Bayesian Forecasting and Dynamic Models", section 10.8. It
/// returns to one as older samples are forgotten:
///   weight  <- f weight + (1 - f) n0 + sum_j mu_j tr(G_j) / n_y,      G_j = S_j^-1 C s Q_j C'
///   squares <- f squares + (1 - f) n0 + s sum_j mu_j e_j' S_j^-1 C s Q_j C' S_j^-1 e_j / n_y,   s = squares / weight.
/// With R = 0 and a known state, `squares` sums the squares of the standardised innovations. Otherwise part of an
/// innovation comes from measurement noise or an uncertain state. This part is excluded in proportion. n_y counts the
/// available signals. (The exact conjugate update would give a Student t distribution instead of the estimate s.)
namespace modebank {

inline constexpr double largest_noise_scale = 1e8;

/// tr(S^-1 C P C') of one Kalman step. `column`: workspace of size n_y.
template <class Sensor, class Matrix, class Kalman, class Column>
double explained_share(const Sensor& sensor, const Matrix& P, const Kalman& kalman, Column& column) {
  double trace = 0.0;
  for (Eigen::Index i = 0; i < column.size(); ++i) {
    for (Eigen::Index a = 0; a < column.size(); ++a) {
      double sum = 0.0;
      for (Eigen::Index q = 0; q < sensor.seen_columns; ++q)
        for (Eigen::Index p = 0; p < sensor.seen_columns; ++p) sum += sensor.C(a, p) * P(p, q) * sensor.C(i, q);
      column(a) = sum;
    }
    kalman.cholesky.solve(column);
    trace += column(i);
  }
  return trace;
}

/// e' S^-1 C P C' S^-1 e of one Kalman step, for the available signals. The factor e' S^-1 e is limited to
/// largest_standardised^2 n_y.
template <class Sensor, class Matrix, class Kalman, class Column>
double explained_square(const Sensor& sensor, const Matrix& P, const Kalman& kalman, double n_y, Column& column) {
  const double nis = kalman.cholesky.squared_distance(kalman.decorrelated);
  const double most = largest_standardised * largest_standardised * n_y;
  if (!(nis < 1e300)) return 0.0;  // an innovation that overflows has no information about the scale
  column = kalman.innovation;
  kalman.cholesky.solve(column);
  double sum = 0.0;
  for (Eigen::Index q = 0; q < sensor.seen_columns; ++q)
    for (Eigen::Index p = 0; p < sensor.seen_columns; ++p) {
      double left = 0.0, right = 0.0;
      for (Eigen::Index i = 0; i < column.size(); ++i) {
        left += sensor.C(i, p) * column(i);
        right += sensor.C(i, q) * column(i);
      }
      sum += left * P(p, q) * right;
    }
  return nis > most ? sum * (most / nis) : sum;
}

/// Updates the scale with one sample. `share`, `square`: the two sums over modes above. Does nothing if a sum
/// overflows.
inline void move_noise_scale(const NoiseAdaptation& adaptation, double share, double square, double n_y, double& scale,
                             double& samples) {
  if (!std::isfinite(share) || !std::isfinite(square)) return;
  const double f = adaptation.forgetting, n0 = adaptation.prior_samples;
  const double squares = f * samples * scale + (1.0 - f) * n0 + scale * square / n_y;
  samples = f * samples + (1.0 - f) * n0 + share / n_y;
  scale = std::clamp(squares / samples, 1.0 / largest_noise_scale, largest_noise_scale);
}

/// Updates state.noise_scale after the measurement. `prior`: probability of every mode before the measurement.
/// step.log_likelihood must have the likelihoods. `sensor` has the C of the measurement.
template <class Model, class Sensor, class Step, class State>
void adapt_noise_scale(const Model& model, const Sensor& sensor, const Eigen::VectorXd& prior, Step& step,
                       State& state) {
  const double s = state.noise_scale, n_y = static_cast<double>(step.residual.size() - step.partial.missing);
  // An impossible mode is excluded even if it fits well, as in Bayes' rule (imm.hpp).
  double largest = -std::numeric_limits<double>::infinity();
  for (Eigen::Index h = 0; h < prior.size(); ++h)
    if (prior(h) >= impossible_probability) largest = std::max(largest, step.log_likelihood(h));
  double total = 0.0, share = 0.0, square = 0.0;
  for (std::size_t h = 0; h < step.kalman.size(); ++h) {
    const auto i = static_cast<Eigen::Index>(h);
    const double weight =
        prior(i) >= impossible_probability ? prior(i) * std::exp(step.log_likelihood(i) - largest) : 0.0;
    if (!(weight > 0.0)) continue;
    // The scale also applies to errors of drifting coefficients, because these are in units of the noise.
    const auto& Q = model.drift.on() ? step.kalman[h].process_noise : model.modes[h].Q;
    const double scaled = model.drift.on() ? weight : weight * s * step.noise_factor;
    total += weight;
    if (sensor.quantised) {
      const IntervalSums sums = interval_sums(sensor, Q, step.kalman[h], largest_standardised * largest_standardised);
      share += scaled * sums.share;
      square += scaled * sums.square;
      continue;
    }
    share += scaled * explained_share(sensor, Q, step.kalman[h], step.residual);
    square += scaled * explained_square(sensor, Q, step.kalman[h], n_y, step.residual);
  }
  if (!(total > 0.0)) return;
  move_noise_scale(model.noise_adaptation, share / total, square / total, n_y, state.noise_scale, state.noise_samples);
}

}  // namespace modebank
