#include "io/import/label_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "modebank/base/error.hpp"

namespace modebank {

void LabelHolder::hold(const LabelStream& source, const std::vector<Trajectory>& parts) {
  std::vector<std::size_t> order;  // indices of the labels that have a time, in order of time
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

void check_labels(const std::string& column, const RunLabels& labels, std::vector<std::string>& notes) {
  constexpr std::size_t usual_kinds = 32, most_kinds = 1000;
  Index samples = 0;
  for (const Eigen::VectorXi& run : labels.of_runs) samples += (run.array() >= 0).count();
  const std::size_t kinds = labels.names.size();
  const std::string found = fmt::format("data.label = {} has {} distinct values in {} samples", column, kinds, samples);
  if (samples == 0) notes.push_back(fmt::format("data.label = {} has no value at any sample", column));
  if (kinds > most_kinds || (kinds > usual_kinds && 4 * kinds > static_cast<std::size_t>(samples)))
    throw ConfigurationError(fmt::format(
        "{} ({}, {}, ...), like a measurement or a name of each row; a label has few values, such as kinds of ground",
        found, labels.names[0], labels.names[1]));
  if (kinds > usual_kinds) notes.push_back(found + "; check that it is a label with few kinds");
}

}  // namespace modebank
