#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank::app::report {

/// "wz [rad/s]"; the name alone if the unit is unknown.
inline std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

/// The name of a model's parameter in words, without its unit: "effective track" for effective_track_m.
inline std::string parameter_words(std::string name, const std::string& unit) {
  if (!unit.empty() && name.ends_with("_" + unit)) name.resize(name.size() - unit.size() - 1);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// The common unit of the channels. If units differ, all of them separated by commas. Empty if a unit is unknown.
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
