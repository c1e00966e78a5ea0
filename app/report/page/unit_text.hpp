#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank::app::report {

/// "wz [rad/s]"; the name alone where nobody stated a unit.
inline std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

/// The channels' unit where they share one, else all of them by commas; empty when one is not known.
inline std::string common_unit(const std::vector<Channel>& channels) {
  std::string all;
  bool same = true;
  for (const Channel& channel : channels) {
    if (channel.unit.empty()) return "";
    same = same && channel.unit == channels.front().unit;
    all += (all.empty() ? "" : ", ") + channel.unit;
  }
  return same && !channels.empty() ? channels.front().unit : all;
}

}  // namespace modebank::app::report
