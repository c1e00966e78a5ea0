#pragma once

#include <string>
#include <string_view>

namespace modebank::app {

/// What a channel's name says of its part, in points; the higher, the surer. Tables of words: app/init/words.cpp.
struct NameScore {
  int state = 0;         ///< measured: what the model is to predict
  int input = 0;         ///< commanded, or acting on the states
  bool ignored = false;  ///< names no signal: times, counters, covariances, text
};

/// `name` as the file has it, with or without the table's name in front; `type` the table's ("sensor_msgs/Imu").
NameScore score_name(std::string_view name, std::string_view type = {});

/// Words of a name in lower case, with a blank before, between and behind: "/imu/data.angular_velocity.z" is
/// " imu data angular velocity z ", "cmd_velL" " cmd vel l ".
std::string words_of_name(std::string_view name);

/// Whether a name says that its values are times, or which run a row belongs to.
bool names_time(std::string_view name);
bool names_date(std::string_view name);
bool names_run(std::string_view name);
/// Whether it says nanoseconds beside a column of seconds.
bool names_nanoseconds(std::string_view name);

/// The unit that goes without saying with such a name, in SI: rad/s of wz; empty when none does.
std::string usual_unit(std::string_view name);

/// A component of a vector in a robot's frame.
enum class Axis { x, y, z };
/// Whether the name is that of an angular rate, or of an acceleration, about or along that axis.
bool names_angular_rate(std::string_view name, Axis axis);
bool names_acceleration(std::string_view name, Axis axis);
/// Whether it is a position along that axis: x, pos_y.
bool names_position(std::string_view name, Axis axis);

/// Units that measured motion has and commands rarely, and the reverse: rad/s, degC; V, %, Nm.
bool unit_of_measured(std::string_view unit);
bool unit_of_acting(std::string_view unit);

}  // namespace modebank::app
