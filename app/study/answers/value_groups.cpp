#include "app/study/answers/value_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>

namespace modebank::app {
namespace {

std::optional<double> as_number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

std::vector<ValueGroup> ranges_of(const std::vector<ValueGroup>& groups) {
  std::vector<std::pair<double, std::size_t>> trials;  // value, row
  for (const ValueGroup& group : groups)
    for (const std::size_t row : group.rows) trials.emplace_back(*as_number(group.label), row);
  std::sort(trials.begin(), trials.end());
  std::vector<ValueGroup> ranges;
  for (std::size_t range = 0, first = 0; range < value_range_count && first < trials.size(); ++range) {
    std::size_t last = std::max(first + 1, trials.size() * (range + 1) / value_range_count);
    while (last < trials.size() && trials[last].first == trials[last - 1].first) ++last;  // equal values stay together
    ValueGroup group{fmt::format("{:.4g}..{:.4g}", trials[first].first, trials[last - 1].first), {}};
    for (; first < last; ++first) group.rows.push_back(trials[first].second);
    std::sort(group.rows.begin(), group.rows.end());
    ranges.push_back(std::move(group));
  }
  return ranges;
}

/// Whether most values have only a single setting, although other keys vary. The effect of the value then cannot be
/// separated from the effect of its setting.
bool are_thin(const StudyTable& table, const std::vector<ValueGroup>& groups) {
  if (table.varied_keys.size() < 2 || groups.size() <= value_range_count) return false;
  std::set<std::vector<std::string>> settings;
  for (const ValueGroup& group : groups)
    for (const std::size_t row : group.rows) settings.insert(table.rows[row].varied);
  return settings.size() < 2 * groups.size();
}

}  // namespace

std::vector<ValueGroup> value_groups(const StudyTable& table, std::size_t key) {
  std::vector<ValueGroup> groups;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.rows[i].status != TrialStatus::done) continue;
    const std::string& value = table.rows[i].varied.at(key);
    const auto [found, fresh] = index.emplace(value, groups.size());
    if (fresh) groups.push_back({value, {}});
    groups[found->second].rows.push_back(i);
  }
  const bool numbers = std::all_of(groups.begin(), groups.end(),
                                   [](const ValueGroup& group) { return as_number(group.label).has_value(); });
  return numbers && (groups.size() > value_group_limit || are_thin(table, groups)) ? ranges_of(groups) : groups;
}

}  // namespace modebank::app
