#include "ident/trajectory.hpp"

#include <algorithm>

namespace modebank {

double Recording::median_period_s() const {
  std::vector<double> periods;
  for (const Trajectory& run : runs)
    for (Index k = 0; k < run.transitions(); ++k) periods.push_back(run.time_s(k + 1) - run.time_s(k));
  if (periods.empty()) return 0.0;
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return *middle;
}

std::vector<std::string> names_of(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (const Channel& channel : channels) names.push_back(channel.name);
  return names;
}

}  // namespace modebank
