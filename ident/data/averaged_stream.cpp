#include "ident/data/averaged_stream.hpp"

#include <algorithm>
#include <cmath>

namespace modebank {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

AveragedStream AveragedStream::linear(const Stream& stream) {
  AveragedStream series;
  series.time_s_ = stream.time_s;
  series.values_ = stream.values;
  series.integral_ = MatrixXd::Zero(stream.values.rows(), stream.values.cols());
  for (Index k = 1; k < stream.time_s.size(); ++k)
    series.integral_.col(k) = series.integral_.col(k - 1) + 0.5 * (stream.time_s(k) - stream.time_s(k - 1)) *
                                                                (stream.values.col(k) + stream.values.col(k - 1));
  return series;
}

AveragedStream AveragedStream::held(const Stream& stream, double time_constant_s) {
  AveragedStream series;
  series.held_ = true;
  series.time_constant_s_ = time_constant_s;
  series.time_s_ = stream.time_s;
  series.values_ = stream.values;
  series.filtered_ = stream.values;
  series.integral_ = MatrixXd::Zero(stream.values.rows(), stream.values.cols());
  for (Index k = 1; k < stream.time_s.size(); ++k) {
    const double dt_s = stream.time_s(k) - stream.time_s(k - 1);
    const auto u = stream.values.col(k - 1);
    if (time_constant_s > 0.0)
      series.filtered_.col(k) = u + std::exp(-dt_s / time_constant_s) * (series.filtered_.col(k - 1) - u);
    // The integral of f is the integral of u minus the time constant times the change of f.
    series.integral_.col(k) = series.integral_.col(k - 1) + dt_s * u;
    if (time_constant_s > 0.0)
      series.integral_.col(k) -= time_constant_s * (series.filtered_.col(k) - series.filtered_.col(k - 1));
  }
  return series;
}

/// Integral from the first sample to `time_s`. Advances `sample` to the last sample at or before `time_s`.
void AveragedStream::integral(double time_s, Index& sample, VectorXd& result) const {
  while (sample + 1 < time_s_.size() && time_s_(sample + 1) <= time_s) ++sample;
  const double dt_s = time_s - time_s_(sample);
  const auto u = values_.col(sample);
  if (dt_s <= 0.0 || (!held_ && sample + 1 == time_s_.size())) {
    result = integral_.col(sample) + dt_s * u;
  } else if (!held_) {
    const double slope_s = 0.5 * dt_s / (time_s_(sample + 1) - time_s_(sample));
    result = integral_.col(sample) + dt_s * (u + slope_s * (values_.col(sample + 1) - u));
  } else {
    result = integral_.col(sample) + dt_s * u;
    if (time_constant_s_ > 0.0)
      result += time_constant_s_ * (1.0 - std::exp(-dt_s / time_constant_s_)) * (filtered_.col(sample) - u);
  }
}

MatrixXd AveragedStream::mean(const VectorXd& centres_s, double width_s) const {
  MatrixXd means(values_.rows(), centres_s.size());
  Index from = 0, to = 0;
  VectorXd before(values_.rows()), after(values_.rows());
  for (Index k = 0; k < centres_s.size(); ++k) {
    integral(centres_s(k) - 0.5 * width_s, from, before);
    integral(centres_s(k) + 0.5 * width_s, to, after);
    means.col(k) = (after - before) / width_s;
  }
  return means;
}

}  // namespace modebank
