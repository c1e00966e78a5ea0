#pragma once

#include <string>
#include <string_view>

namespace modebank::app {

/// A channel's role by its name, in points; more points are surer. Tables of words: app/init/words.cpp.
struct NameScore {
  int state = 0;         ///< measured: the model is to predict it
  int input = 0;         ///< commanded, or acting on the states
  bool ignored = false;  ///< not a signal: times, counters, covariances, text
};

/// `name` as in the file, with or without the table's name in front; `type`: the table's ("sensor_msgs/Imu").
NameScore score_name(std::string_view name, std::string_view type = {});

/// Words of a name in lower case, with a blank before, between and behind: "/imu/data.angular_velocity.z" is
/// " imu data angular velocity z ", "cmd_velL" " cmd vel l ".
std::string words_of_name(std::string_view name);

/// Whether a name means times, or the run that a row belongs to.
bool names_time(std::string_view name);
bool names_date(std::string_view name);
bool names_run(std::string_view name);
/// Whether a name means nanoseconds beside a column of seconds.
bool names_nanoseconds(std::string_view name);

/// The usual SI unit of such a name: rad/s for wz; empty when it has none.
std::string usual_unit(std::string_view name);

/// A component of a vector in a robot's frame.
enum class Axis { x, y, z };
/// Whether a name means an angular rate about this axis, or an acceleration along it.
bool names_angular_rate(std::string_view name, Axis axis);
bool names_acceleration(std::string_view name, Axis axis);
/// Whether a name means a position along this axis: x, pos_y.
bool names_position(std::string_view name, Axis axis);

/// Units that are common for measured motion and rare for commands (rad/s, degC), and the reverse (V, %, Nm).
bool unit_of_measured(std::string_view unit);
bool unit_of_acting(std::string_view unit);

}  // namespace modebank::app
