#pragma once

#include <string>
#include <vector>

#include "app/text/mode_families.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

/// Numbers of a robot on two rows of wheels: track width, wheel radii, delays, noise. Standard errors by the delta
/// method.
namespace modebank::app {

/// Data on a robot that the archive does not contain; 0: unknown.
struct RobotSizes {
  double wheel_separation_m = 0.0, wheel_radius_m = 0.0;
};

/// A bank and the channels from which it was learned.
struct RobotBank {
  const Bank& bank;
  const std::vector<Channel>& measurements;     ///< n_y
  const std::vector<Channel>& recorded_inputs;  ///< u as recorded
  double input_lag_s = 0.0;  ///< shift of the inputs: the bank uses inputs this much earlier than recorded
};

/// Indices of the robot's channels; -1: there is none.
struct RobotChannels {
  Index yaw_rate = -1, forward_speed = -1;  ///< among the measured states
  Index left = -1, right = -1;              ///< among the recorded inputs
  bool wheels_in_rad_s = false;             ///< if false, the inputs are in m/s
  std::vector<std::string> missing;         ///< what is missing, and how to state it
};
/// Found by their units, and by their names if units do not decide.
RobotChannels robot_channels(const RobotBank& bank);

/// NaN if the bank does not determine the number.
struct Estimate {
  double value, error;
  std::vector<Index> modes{};  ///< modes that enter the mean, if not all modes of the family do
  bool known() const;
  bool vague() const;  ///< whether the standard error exceeds the value
};

/// Numbers of one mode, or means over several. G is the gain of the yaw rate (left, right), H that of the forward
/// speed. r is the wheel's radius for inputs in rad/s, and 1 for m/s.
/// - separation = (m_L + m_R) r / (G_R - G_L)
/// - multipliers: m_L r = 2 H_L, m_R r = 2 H_R
/// - Without a forward speed only m_R / m_L = -G_R / G_L is known; m_L + m_R = 2 is assumed.
struct RobotNumbers {
  Estimate separation_m, left_multiplier, right_multiplier;  ///< factors of the wheel's radius
  Estimate yaw_delay_s, forward_delay_s;
  Estimate yaw_variance, forward_variance;  ///< variance of the state about its stationary value
};
RobotNumbers robot_numbers(const RobotBank& bank, Index mode, const RobotChannels& channels, const RobotSizes& sizes);

/// Means over the modes of a family, weighted by use.
/// - A mode whose number is unknown or vague does not enter the mean of this number.
/// - Standard errors include the modes' errors and the differences between the modes (pooled_number).
/// - The separation follows from the mean turn per difference of wheel speeds.
/// - A mean variance is the variance over the whole time; its standard error is that of this mean.
RobotNumbers family_numbers(const RobotBank& bank, const ModeFamily& family, const RobotChannels& channels,
                            const RobotSizes& sizes);

/// Covariance of the process noise per step, C Q C', over a family: the mean by use, its standard errors (empty if
/// unknown), the smallest and the largest of the modes.
struct FamilyNoise {
  Eigen::MatrixXd Q, error, least, largest;
};
FamilyNoise family_noise(const RobotBank& bank, const ModeFamily& family);

}  // namespace modebank::app
