#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace modebank::app {

/// Points for a channel's role, from its name. More points mean more certainty. app/init/words.cpp has the tables of
/// words.
struct NameScore {
  int state = 0;         ///< points for a measured channel, which the model is to predict
  int input = 0;         ///< points for a commanded channel, or one that acts on the states
  bool ignored = false;  ///< true for times, counters, covariances and text
};

/// `name`: as in the file, with or without the table's name in front. `type`: type of the table ("sensor_msgs/Imu").
NameScore score_name(std::string_view name, std::string_view type = {});

/// Words of a name in lower case, with a blank before, between and after them. "/imu/data.angular_velocity.z" becomes "
/// imu data angular velocity z ", and "cmd_velL" becomes " cmd vel l ".
std::string words_of_name(std::string_view name);

/// Whether the name is that of times, or of the run to which a row belongs.
bool names_time(std::string_view name);
bool names_run(std::string_view name);
/// Whether the name is that of nanoseconds beside a column of seconds.
bool names_nanoseconds(std::string_view name);

/// The words of a name without one of these: the first that the name contains. Empty if it contains none.
std::string words_without(std::span<const char* const> list, std::string_view name);
/// For the name of a set point, the words of the quantity: " level cm " for level_setpoint_cm. Empty for other names.
std::string words_of_measured(std::string_view name);

/// The usual SI unit for a name: rad/s for wz. Empty if there is none.
std::string usual_unit(std::string_view name);

/// Axis of a vector in a robot's frame.
enum class Axis { x, y, z };
/// Whether the name is that of an angular rate about this axis, or of an acceleration along it.
bool names_angular_rate(std::string_view name, Axis axis);
bool names_acceleration(std::string_view name, Axis axis);
/// Whether the name is that of a position along this axis: x, pos_y.
bool names_position(std::string_view name, Axis axis);

/// Two functions: units that are common for measured motion and rare for commands (rad/s, degC), and units for which
/// the reverse holds (V, %, Nm).
bool unit_of_measured(std::string_view unit);
bool unit_of_acting(std::string_view unit);

/// The value that makes a column text, with the key that helps. It is the first value that begins like a number, or the
/// first value if there is none. Empty if all values are equal.
std::string why_no_numbers(const std::vector<std::string>& texts);
inline constexpr std::string_view changing_text = ", and it changes from row to row";  ///< end of such a line

}  // namespace modebank::app
