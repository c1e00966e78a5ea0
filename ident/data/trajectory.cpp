#include "ident/data/trajectory.hpp"

#include <algorithm>

namespace modebank {

double median_period_s(const std::vector<const Eigen::VectorXd*>& times_s) {
  std::vector<double> periods;
  for (const Eigen::VectorXd* time_s : times_s)
    for (Index k = 1; k < time_s->size(); ++k) periods.push_back((*time_s)(k) - (*time_s)(k - 1));
  if (periods.empty()) return 0.0;
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return *middle;
}

double median_period_s(const Eigen::VectorXd& time_s) { return median_period_s(std::vector{&time_s}); }

double Recording::median_period_s() const {
  std::vector<const Eigen::VectorXd*> times_s;
  for (const Trajectory& run : runs) times_s.push_back(&run.time_s);
  return modebank::median_period_s(times_s);
}

std::vector<std::string> names_of(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (const Channel& channel : channels) names.push_back(channel.name);
  return names;
}

}  // namespace modebank
