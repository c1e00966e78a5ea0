#include "io/import/label_streams.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace modebank {

void LabelHolder::hold(const LabelStream& source, const std::vector<Trajectory>& parts) {
  std::vector<std::size_t> order;  // of labels that have a time, by time
  for (std::size_t k = 0; k < source.text.size(); ++k)
    if (!std::isnan(source.time_s(static_cast<Index>(k))) && !source.text[k].empty()) order.push_back(k);
  const auto time = [&](std::size_t k) { return source.time_s(static_cast<Index>(k)); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return time(a) < time(b); });
  constexpr double rounding_s = 1e-9;
  for (const Trajectory& run : parts) {
    std::vector<std::string>& labels = of_run_[run.run];
    std::size_t next = 0;
    for (Index k = 0; k < run.samples(); ++k) {
      while (next < order.size() && time(order[next]) <= run.time_s(k) + rounding_s) ++next;
      labels.push_back(next == 0 ? std::string() : source.text[order[next - 1]]);
    }
  }
}

RunLabels LabelHolder::of(const std::vector<Trajectory>& runs) const {
  std::set<std::string> names;
  for (const auto& [run, labels] : of_run_)
    for (const std::string& label : labels)
      if (!label.empty()) names.insert(label);
  RunLabels result{{names.begin(), names.end()}, {}};
  for (const Trajectory& run : runs) {
    Eigen::VectorXi& positions = result.of_runs.emplace_back(Eigen::VectorXi::Constant(run.samples(), -1));
    const std::vector<std::string>& labels = of_run_.at(run.run);
    for (Index k = 0; k < run.samples(); ++k)
      if (const auto found = names.find(labels[static_cast<std::size_t>(k)]); found != names.end())
        positions(k) = static_cast<int>(std::distance(names.begin(), found));
  }
  return result;
}

}  // namespace modebank
