#include "ident/fit/linearise.hpp"

#include <algorithm>
#include <cmath>

#include "ident/fit/motion_residuals.hpp"

namespace modebank {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr double difference_share = 1e-6;  // share of a parameter's size

// assumed size of a parameter near zero; the rounding error of a derivative is then 2e-8
constexpr double least_size = 1e-2;

Eigen::VectorXd linear_theta(const MotionModel& model, const Eigen::VectorXd& theta, const OperatingPoint& at) {
  const Index n = model.states(), m = model.inputs(), p = model.parameter_count();
  RowMajor by_theta(n, p), by_x(n, n), by_u(n, m);
  Eigen::VectorXd next(n);
  model.predict(theta.data(), at.state.data(), at.input.data(), at.dt_s, next.data(), by_theta.data(), by_x.data(),
                by_u.data());
  RowMajor rows(n, n + m + 1);
  rows.leftCols(n) = by_x - RowMajor::Identity(n, n);
  rows.middleCols(n, m) = by_u;
  rows.col(n + m) = next - by_x * at.state - by_u * at.input;
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace

OperatingPoint operating_point(const Recording& recording, const Eigen::VectorXd& weights) {
  OperatingPoint point{Eigen::VectorXd::Zero(recording.state_count()), Eigen::VectorXd::Zero(recording.input_count()),
                       recording.median_period_s()};
  double sum = 0.0;
  Index position = 0;
  for (const TransitionRange& s : training_stretches(recording))
    for (Index k = s.start; k < s.start + s.length; ++k, ++position) {
      const double weight = weights.size() > 0 ? weights(position) : 1.0;
      if (!s.run->state.col(k).allFinite() || !s.run->input.col(k).allFinite() || !(weight > 0.0)) continue;
      point.state += weight * s.run->state.col(k);
      point.input += weight * s.run->input.col(k);
      sum += weight;
    }
  if (sum > 0.0) {
    point.state /= sum;
    point.input /= sum;
  }
  return point;
}

LinearisedMotion linearise(const MotionModel& model, const Eigen::VectorXd& theta, const OperatingPoint& at) {
  LinearisedMotion result{linear_theta(model, theta, at), {}};
  result.by_motion.resize(result.theta.size(), theta.size());
  for (Index j = 0; j < theta.size(); ++j) {
    const double h = difference_share * std::max(std::abs(theta(j)), least_size);
    Eigen::VectorXd above = theta, below = theta;
    above(j) += h;
    below(j) -= h;
    result.by_motion.col(j) = (linear_theta(model, above, at) - linear_theta(model, below, at)) / (above(j) - below(j));
  }
  return result;
}

GlobalModel linearise(const MotionModel& model, const GlobalModel& global, const OperatingPoint& at) {
  const LinearisedMotion motion = linearise(model, global.theta, at);
  GlobalModel linear = global;
  linear.theta = motion.theta;
  linear.covariance = motion.by_motion * global.covariance * motion.by_motion.transpose();
  return linear;
}

GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const MotionModel* motion) {
  return motion ? linearise(*motion, windows.global, operating_point(recording)) : windows.global;
}

}  // namespace modebank
