#pragma once

#include <string_view>

namespace modebank {

/// A channel's name, followed by a blank and the unit in brackets: "wz [deg/s]", "t (ms)".
struct NameAndUnit {
  std::string_view name;
  std::string_view unit;  ///< empty if the name contains no unit
};
NameAndUnit split_unit(std::string_view name);

/// The unit without brackets: rad/s for "[rad/s]", "(rad/s)" and "rad/s".
std::string_view bare_unit(std::string_view unit);

}  // namespace modebank
