#include "app/report/figures/shown_groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "app/text/mode_words.hpp"

namespace modebank::app::report {

std::string ShownGroups::others_title() const {
  return others.size() == 1 ? "1 other" : fmt::format("{} others", others.size());
}

ShownGroups shown_groups(const Eigen::VectorXd& sizes) {
  std::vector<Index> order(static_cast<std::size_t>(sizes.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return sizes(a) > sizes(b); });
  const auto border = order.begin() + std::min(std::ssize(order), static_cast<Index>(most_shown_groups));
  ShownGroups groups{{order.begin(), border}, {border, order.end()}};
  std::sort(groups.shown.begin(), groups.shown.end());
  std::sort(groups.others.begin(), groups.others.end());
  return groups;
}

ShownGroups shown_modes(const Archive& archive) {
  const std::vector<UsedMode> used = used_modes(archive);
  const Index told = told_modes(used);
  ShownGroups groups;
  for (const UsedMode& mode : used)
    (std::ssize(groups.shown) < told ? groups.shown : groups.others).push_back(mode.mode);
  return groups;
}

}  // namespace modebank::app::report
