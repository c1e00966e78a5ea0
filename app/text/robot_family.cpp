// Numbers of a robot, as means over the modes of a family.

#include "app/text/robot_numbers.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The estimates that enter a mean, with their weights and modes.
struct Counted {
  VectorXd values, errors, weights;
  std::vector<Index> modes;
};

template <class Counts>
Counted those_that_count(const std::vector<Estimate>& estimates, const ModeFamily& family, Counts counts) {
  Counted of{VectorXd(std::ssize(estimates)), VectorXd(std::ssize(estimates)), VectorXd(std::ssize(estimates)), {}};
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (!counts(estimates[i])) continue;
    const Index at = std::ssize(of.modes);
    of.values(at) = estimates[i].value;
    of.errors(at) = estimates[i].error;
    of.weights(at) = family.uses[i];
    of.modes.push_back(family.modes[i]);
  }
  for (VectorXd* v : {&of.values, &of.errors, &of.weights}) v->conservativeResize(std::ssize(of.modes));
  return of;
}

Estimate with_modes(const PooledNumber& number, const Counted& of, const ModeFamily& family) {
  return {number.value, number.error, of.modes.size() < family.modes.size() ? of.modes : std::vector<Index>()};
}

/// Mean of the estimates that are known and not vague. If all known estimates are vague, their mean.
Estimate mean_of(const std::vector<Estimate>& estimates, const ModeFamily& family) {
  Counted of = those_that_count(estimates, family, [](const Estimate& one) { return one.known() && !one.vague(); });
  if (of.modes.empty()) of = those_that_count(estimates, family, [](const Estimate& one) { return one.known(); });
  if (of.modes.empty()) return {not_a_number, not_a_number};
  return with_modes(pooled_number(of.values, of.errors, of.weights), of, family);
}

/// If the wheels turn but the robot does not, the separation is infinite. So the mean is taken over the inverse, which
/// is the turn per difference of wheel speeds.
Estimate mean_separation(std::vector<Estimate> separations, const ModeFamily& family) {
  const auto inverse = [](Estimate of) {
    of.error /= of.value * of.value;
    of.value = 1.0 / of.value;
    return of;
  };
  for (Estimate& separation : separations) separation = inverse(separation);
  return inverse(mean_of(separations, family));
}

/// The variance over the whole time is the mean of the modes' variances. The error is the error of this mean.
/// Differences between the modes do not add to it.
Estimate mean_variance(const std::vector<Estimate>& estimates, const ModeFamily& family) {
  const Counted of = those_that_count(estimates, family, [](const Estimate& one) { return one.known(); });
  if (of.modes.empty()) return {not_a_number, not_a_number};
  const VectorXd w = shares_of(of.weights);
  return with_modes({w.dot(of.values), w.cwiseProduct(of.errors).norm()}, of, family);
}

}  // namespace

RobotNumbers family_numbers(const RobotBank& robot, const ModeFamily& family, const RobotChannels& channels,
                            const RobotSizes& sizes) {
  std::vector<RobotNumbers> all;
  for (const Index mode : family.modes) all.push_back(robot_numbers(robot, mode, channels, sizes));
  if (all.size() == 1) return all.front();
  const auto each = [&](Estimate RobotNumbers::*member) {
    std::vector<Estimate> estimates;
    for (const RobotNumbers& one : all) estimates.push_back(one.*member);
    return estimates;
  };
  const auto mean = [&](Estimate RobotNumbers::*member) { return mean_of(each(member), family); };
  return {mean_separation(each(&RobotNumbers::separation_m), family),
          mean(&RobotNumbers::left_multiplier),
          mean(&RobotNumbers::right_multiplier),
          mean(&RobotNumbers::yaw_delay_s),
          mean(&RobotNumbers::forward_delay_s),
          mean_variance(each(&RobotNumbers::yaw_variance), family),
          mean_variance(each(&RobotNumbers::forward_variance), family)};
}

FamilyNoise family_noise(const RobotBank& robot, const ModeFamily& family) {
  const Bank& bank = robot.bank;
  const Index signals = bank.C.rows();
  const VectorXd w = shares_of(Eigen::Map<const VectorXd>(family.uses.data(), std::ssize(family.uses)));
  FamilyNoise noise{MatrixXd::Zero(signals, signals), MatrixXd::Zero(signals, signals), {}, {}};
  for (std::size_t i = 0; i < family.modes.size(); ++i) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(family.modes[i])];
    const MatrixXd Q = bank.C * mode.Q * bank.C.transpose();
    const double share = w(static_cast<Index>(i));
    noise.Q += share * Q;
    noise.least = i == 0 ? Q : MatrixXd(noise.least.cwiseMin(Q));
    noise.largest = i == 0 ? Q : MatrixXd(noise.largest.cwiseMax(Q));
    const bool known = mode.Q_standard_error.rows() >= signals && mode.Q_standard_error.cols() >= signals;
    if (known && noise.error.size() > 0)
      noise.error += share * share * mode.Q_standard_error.topLeftCorner(signals, signals).cwiseAbs2();
    else
      noise.error.resize(0, 0);
  }
  noise.error = noise.error.cwiseSqrt().eval();
  return noise;
}

}  // namespace modebank::app
