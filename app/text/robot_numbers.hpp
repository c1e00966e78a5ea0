#pragma once

#include <string>
#include <vector>

#include "app/text/mode_families.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

/// Numbers of a robot on two rows of wheels: track width, wheel radii, delays, noise. Standard errors by the delta
/// method.
namespace modebank::app {

/// What of a robot the archive does not hold; 0: not known.
struct RobotSizes {
  double wheel_separation_m = 0.0, wheel_radius_m = 0.0;
};

/// A bank with the channels that it was learned from.
struct RobotBank {
  const Bank& bank;
  const std::vector<Channel>& measurements;     ///< n_y
  const std::vector<Channel>& recorded_inputs;  ///< u as it is recorded
  double input_lag_s = 0.0;                     ///< inputs were taken this much earlier than recorded
};

/// Where the robot's channels stand; -1: there is none.
struct RobotChannels {
  Index yaw_rate = -1, forward_speed = -1;  ///< among the measured states
  Index left = -1, right = -1;              ///< among the recorded inputs
  bool wheels_in_rad_s = false;             ///< else they are m/s already
  std::vector<std::string> missing;         ///< in words, each with what would tell
};
/// By their units, and by their names where units do not decide.
RobotChannels robot_channels(const RobotBank& bank);

/// NaN where the bank does not determine it.
struct Estimate {
  double value, error;
  std::vector<Index> modes{};  ///< of a family those that it is a mean of, where not all have it
  bool known() const;
  bool vague() const;  ///< whether the standard error exceeds the value
};

/// Numbers of one mode, or means over several. With G the gains of yaw rate (left, right) and H those of forward speed,
/// and r the wheel's radius where inputs are rad/s (1 for m/s):
///   separation = (m_L + m_R) r / (G_R - G_L),  m_L r = 2 H_L, m_R r = 2 H_R;
/// without a forward speed only m_R / m_L = -G_R / G_L is known, and m_L + m_R = 2 is taken.
struct RobotNumbers {
  Estimate separation_m, left_multiplier, right_multiplier;  ///< multipliers of the radius
  Estimate yaw_delay_s, forward_delay_s;
  Estimate yaw_variance, forward_variance;  ///< of the state about its steady value
};
RobotNumbers robot_numbers(const RobotBank& bank, Index mode, const RobotChannels& channels, const RobotSizes& sizes);

/// Means over the modes of a family by their use. A mode whose number is not known or vague does not count in it.
/// Errors hold those of the modes and how far they are apart (pooled_number). The separation is that of the mean turn
/// per difference of wheel speeds. A mean variance is that of the whole time, and its error that of the mean alone.
RobotNumbers family_numbers(const RobotBank& bank, const ModeFamily& family, const RobotChannels& channels,
                            const RobotSizes& sizes);

/// Covariance of the process noise per step, C Q C', over a family: mean by use, its standard errors (empty: not
/// known), the least and the largest of the modes.
struct FamilyNoise {
  Eigen::MatrixXd Q, error, least, largest;
};
FamilyNoise family_noise(const RobotBank& bank, const ModeFamily& family);

}  // namespace modebank::app
