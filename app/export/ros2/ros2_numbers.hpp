#pragma once

#include <string>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "app/export/forms.hpp"

/// What a mode says of a robot on two rows of wheels, with standard errors by the delta method.
namespace modebank::app {

/// Where the robot's channels stand; -1: there is none.
struct RobotChannels {
  Index yaw_rate = -1, forward_speed = -1;  ///< among the measured states
  Index left = -1, right = -1;              ///< among the recorded inputs
  bool wheels_in_rad_s = false;             ///< else they are m/s already
  std::vector<std::string> missing;         ///< in words, each with what would tell
};
/// By their units, and by their names where units do not decide.
RobotChannels robot_channels(const ExportedBank& bank);

/// NaN where the bank does not determine it.
struct Estimate {
  double value, error;
  bool known() const;
};

/// Of one mode. With G the steady gains of yaw rate (left, right) and H those of forward speed, and r the wheel's
/// radius where inputs are rad/s (1 for m/s):
///   separation = (m_L + m_R) r / (G_R - G_L),  m_L r = 2 H_L, m_R r = 2 H_R;
/// without a forward speed only m_R / m_L = -G_R / G_L is known, and m_L + m_R = 2 is taken.
struct RobotNumbers {
  Estimate separation_m, left_multiplier, right_multiplier;  ///< multipliers of the radius
  Estimate yaw_delay_s, forward_delay_s;
  Estimate yaw_variance, forward_variance;  ///< of the state about its steady value
};
RobotNumbers robot_numbers(const ExportedBank& bank, Index mode, const RobotChannels& channels,
                           const RobotSizes& sizes);

}  // namespace modebank::app
