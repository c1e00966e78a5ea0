#pragma once

#include <string>
#include <vector>

#include "app/text/mode_families.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

/// Numbers of a robot with two rows of wheels: track width, wheel radii, delays, noise. The delta method gives their
/// standard errors.
namespace modebank::app {

/// Dimensions of a robot, which the archive does not contain. 0 means unknown.
struct RobotSizes {
  double wheel_separation_m = 0.0, wheel_radius_m = 0.0;
};

/// A bank, and the channels from which it was learned.
struct RobotBank {
  const Bank& bank;
  const std::vector<Channel>& measurements;     ///< n_y
  const std::vector<Channel>& recorded_inputs;  ///< the inputs as recorded
  double input_lag_s = 0.0;                     ///< time by which the bank uses its inputs earlier than recorded
};

/// Indices of the robot's channels; -1 for a missing channel.
struct RobotChannels {
  Index yaw_rate = -1, forward_speed = -1;  ///< index among the measured states
  Index left = -1, right = -1;              ///< index among the recorded inputs
  bool wheels_in_rad_s = false;             ///< true for inputs in rad/s, false for inputs in m/s
  std::vector<std::string> missing;         ///< texts that name a missing channel and how to state it
};
/// Finds the channels by their units. If units are not enough, names decide.
RobotChannels robot_channels(const RobotBank& bank);

/// An estimated number; NaN if the bank does not determine it.
struct Estimate {
  double value, error;
  std::vector<Index> modes{};  ///< modes that enter the mean; empty if all modes of the family do
  bool known() const;
  bool vague() const;  ///< true if the standard error exceeds the value
};

/// Numbers of one mode, or means over several modes. G is the gain of the yaw rate (left, right), and H is the gain of
/// the forward speed. r is the wheel's radius for inputs in rad/s, and 1 for inputs in m/s.
/// - separation = (m_L + m_R) r / (G_R - G_L)
/// - multipliers: m_L r = 2 H_L, m_R r = 2 H_R
/// - Without a forward speed, only m_R / m_L = -G_R / G_L is known. Then m_L + m_R = 2 is assumed.
struct RobotNumbers {
  Estimate separation_m, left_multiplier, right_multiplier;  ///< each multiplier multiplies the nominal radius of its
                                                             ///< wheel
  Estimate yaw_delay_s, forward_delay_s;
  Estimate yaw_variance, forward_variance;  ///< variance of the state about its stationary value
};
RobotNumbers robot_numbers(const RobotBank& bank, Index mode, const RobotChannels& channels, const RobotSizes& sizes);

/// Means over the modes of a family, weighted by use.
/// - A mode with an unknown or vague number does not enter the mean of this number.
/// - Standard errors include the modes' errors and the differences between the modes (pooled_number).
/// - The separation is computed from the mean turn per difference of wheel speeds.
/// - A mean variance is the variance over the whole time. Its standard error is the error of this mean.
RobotNumbers family_numbers(const RobotBank& bank, const ModeFamily& family, const RobotChannels& channels,
                            const RobotSizes& sizes);

/// Covariance of the process noise per step, C Q C', for a family. It has the mean weighted by use, the mean's standard
/// errors (empty if unknown), and the smallest and largest values among the modes.
struct FamilyNoise {
  Eigen::MatrixXd Q, error, least, largest;
};
FamilyNoise family_noise(const RobotBank& bank, const ModeFamily& family);

}  // namespace modebank::app
