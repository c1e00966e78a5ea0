#include "app/text/robot_numbers.hpp"

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "app/text/mode_dynamics.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

bool holds_any(const std::string& name, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return boost::algorithm::icontains(name, word); });
}

/// The only channel with the unit, or the only channel with both the unit and a suitable name. -1 if there is none or
/// more than one.
Index find_channel(const std::vector<Channel>& channels, const char* unit, std::initializer_list<const char*> words) {
  std::vector<Index> by_unit, by_name;
  for (Index i = 0; i < std::ssize(channels); ++i) {
    const Channel& channel = channels[static_cast<std::size_t>(i)];
    if (channel.unit != unit) continue;
    by_unit.push_back(i);
    if (holds_any(channel.name, words)) by_name.push_back(i);
  }
  const std::vector<Index>& found = by_unit.size() == 1 ? by_unit : by_name;
  return found.size() == 1 ? found.front() : -1;
}

/// Whether a name contains a side, as in "left", "wheel_left", "velL" or "vel_l".
bool is_side(const std::string& name, const char* word, char letter) {
  return holds_any(name, {word}) || boost::algorithm::ends_with(name, std::string("_") + letter) ||
         boost::algorithm::ends_with(name, std::string(1, static_cast<char>(letter - 'a' + 'A')));
}

void find_wheels(const std::vector<Channel>& inputs, RobotChannels& channels) {
  for (Index i = 0; i < std::ssize(inputs); ++i) {
    const std::string& name = inputs[static_cast<std::size_t>(i)].name;
    const bool left = is_side(name, "left", 'l'), right = is_side(name, "right", 'r');
    if (left && !right && channels.left < 0) channels.left = i;
    if (right && !left && channels.right < 0) channels.right = i;
  }
  if (channels.left < 0 || channels.right < 0) {
    channels.missing.push_back("no two inputs named as left and right wheel speeds");
  } else {
    const std::string& unit = inputs[static_cast<std::size_t>(channels.left)].unit;
    channels.wheels_in_rad_s = unit == "rad/s";
    const bool alike = unit == inputs[static_cast<std::size_t>(channels.right)].unit;
    if (alike && (unit == "rad/s" || unit == "m/s")) return;
    channels.missing.push_back("wheel speeds need data.input_unit = m/s or rad/s");
  }
  channels.left = channels.right = -1;
}

/// Steady gains per recorded input, and the negative slope of the transfer function at z = 1. This slope is the sum of
/// lag times impulse response.
struct Response {
  MatrixXd gain, delay_gain;  ///< n_y x inputs
};

Response response_of(const Bank& bank, const LinearModel& model) {
  const LinearStructure& s = bank.structure;
  MatrixXd held = MatrixXd::Zero(s.dimension(), s.inputs), late = held;
  for (Index lag = 0; lag < s.input_lags; ++lag) {
    const auto B = model.B.middleCols(lag * s.inputs, s.inputs);
    held += B;
    for (Index j = 0; j < s.inputs; ++j) late.col(j) += static_cast<double>(s.input_delay[j] - 1 + lag) * B.col(j);
  }
  const PivotedLu lu(-model.A);
  const MatrixXd unknown = MatrixXd::Constant(bank.C.rows(), s.inputs, not_a_number);
  if (!lu.invertible()) return {unknown, unknown};
  const MatrixXd once = lu.solve(held);
  return {bank.C * once, bank.C * (lu.solve(once) + lu.solve(late))};
}

/// The mean delay of a response [s]. It is the first moment of the impulse response divided by its sum. It counts from
/// the middle of the sample in which the input is held.
double mean_delay_s(double gain, double delay_gain, double dt_s, double input_lag_s) {
  return dt_s * (delay_gain / gain - 0.5) + input_lag_s;
}

/// Wheel separation, left and right multiplier, and the delays of the yaw rate and of the forward speed.
VectorXd wheel_numbers(const RobotBank& robot, const LinearModel& model, const RobotChannels& at,
                       const RobotSizes& sizes) {
  VectorXd numbers = VectorXd::Constant(5, not_a_number);
  if (at.left < 0 || at.yaw_rate < 0) return numbers;
  const Response response = response_of(robot.bank, model);
  const double radius = !at.wheels_in_rad_s ? 1.0 : sizes.wheel_radius_m > 0.0 ? sizes.wheel_radius_m : not_a_number;
  const double G_L = response.gain(at.yaw_rate, at.left), G_R = response.gain(at.yaw_rate, at.right);
  const auto delay = [&](Index state, double sign) {
    return mean_delay_s(response.gain(state, at.right) + sign * response.gain(state, at.left),
                        response.delay_gain(state, at.right) + sign * response.delay_gain(state, at.left),
                        robot.bank.dt_s, robot.input_lag_s);
  };
  numbers(3) = delay(at.yaw_rate, -1.0);
  if (at.forward_speed < 0) {
    numbers(0) = 2.0 * radius / (G_R - G_L);
    numbers(1) = -2.0 * G_L / (G_R - G_L);
    numbers(2) = 2.0 * G_R / (G_R - G_L);
    return numbers;
  }
  const double H_L = response.gain(at.forward_speed, at.left), H_R = response.gain(at.forward_speed, at.right);
  numbers(0) = 2.0 * (H_L + H_R) / (G_R - G_L);
  numbers(1) = 2.0 * H_L / radius;
  numbers(2) = 2.0 * H_R / radius;
  numbers(4) = delay(at.forward_speed, 1.0);
  return numbers;
}

/// Solves P = F P F' + Q by doubling; empty if the mode is not stable.
MatrixXd stationary_covariance(MatrixXd F, MatrixXd P) {
  constexpr int doublings = 60;
  if (eigenvalues(F).cwiseAbs().maxCoeff() >= 1.0) return {};
  for (int i = 0; i < doublings; ++i) {
    P += (F * P * F.transpose()).eval();
    F = (F * F).eval();
  }
  return P;
}

/// Variances of the measured states about their stationary values, from P = A P A' + Q. NaN if the mode is not stable.
VectorXd stationary_variances(const RobotBank& robot, const LinearModel& model, const MatrixXd& Q) {
  const MatrixXd& C = robot.bank.C;
  const MatrixXd P = stationary_covariance(model.full_form(), Q);
  if (P.size() == 0) return VectorXd::Constant(C.rows(), not_a_number);
  return (C * P * C.transpose()).diagonal();
}

/// Same as stationary_variances, with standard errors. The delta method gives the part from theta. The part from Q is
/// the sum over the entries of Q, because the variances are linear in Q.
DerivedNumbers variances_of(const RobotBank& robot, Index mode) {
  const Mode& of = robot.bank.modes[static_cast<std::size_t>(mode)];
  DerivedNumbers result = derived_numbers(
      robot.bank, mode, [&](const LinearModel& model) { return stationary_variances(robot, model, of.Q); });
  VectorXd squares = result.errors.array().square();
  if (of.Q_standard_error.size() == 0) squares.setConstant(not_a_number);
  for (Index i = 0; i < of.Q_standard_error.rows(); ++i)
    for (Index j = 0; j <= i; ++j) {
      if (of.Q_standard_error(i, j) == 0.0) continue;
      MatrixXd unit = MatrixXd::Zero(of.Q.rows(), of.Q.cols());
      unit(i, j) = unit(j, i) = of.Q_standard_error(i, j);
      squares.array() += stationary_variances(robot, of.model, unit).array().square();
    }
  result.errors = squares.cwiseSqrt();
  return result;
}

}  // namespace

bool Estimate::known() const { return std::isfinite(value); }

bool Estimate::vague() const { return std::abs(value) < error; }

RobotChannels robot_channels(const RobotBank& robot) {
  RobotChannels channels;
  channels.yaw_rate = find_channel(robot.measurements, "rad/s", {"wz", "yaw", "gyro_z", "angular.z", "omega_z"});
  channels.forward_speed = find_channel(robot.measurements, "m/s", {"vx", "forward", "linear.x", "speed", "surge"});
  if (channels.yaw_rate < 0)
    channels.missing.push_back("no state is the yaw rate (state its unit, data.state_unit = rad/s)");
  if (channels.forward_speed < 0)
    channels.missing.push_back("no state is the forward speed (state its unit, data.state_unit = m/s)");
  find_wheels(robot.recorded_inputs, channels);
  return channels;
}

RobotNumbers robot_numbers(const RobotBank& robot, Index mode, const RobotChannels& channels, const RobotSizes& sizes) {
  const DerivedNumbers derived = derived_numbers(
      robot.bank, mode, [&](const LinearModel& model) { return wheel_numbers(robot, model, channels, sizes); });
  const DerivedNumbers variances = variances_of(robot, mode);
  const auto variance = [&](Index state) {
    return state < 0 ? Estimate{not_a_number, not_a_number}
                     : Estimate{variances.values(state), variances.errors(state)};
  };
  const auto at = [&](Index i) { return Estimate{derived.values(i), derived.errors(i)}; };
  RobotNumbers numbers{
      at(0), at(1), at(2), at(3), at(4), variance(channels.yaw_rate), variance(channels.forward_speed)};
  // The gains of an unstable mode have no meaning. The separation has no meaning if a mode turns against its wheels.
  const bool settles = variances.values.allFinite();
  for (Estimate* estimate : {&numbers.separation_m, &numbers.left_multiplier, &numbers.right_multiplier})
    if (!settles || !(numbers.left_multiplier.value > 0.0 && numbers.right_multiplier.value > 0.0))
      *estimate = {not_a_number, not_a_number};
  if (!(numbers.separation_m.value > 0.0)) numbers.separation_m = {not_a_number, not_a_number};
  for (Estimate* delay : {&numbers.yaw_delay_s, &numbers.forward_delay_s})
    if (!settles || !(delay->value >= 0.0)) *delay = {not_a_number, not_a_number};
  return numbers;
}

}  // namespace modebank::app
