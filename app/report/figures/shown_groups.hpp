#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Which of many modes or components a figure tells apart: no more than eye and palette can; the others are drawn
/// alike. Position i among `shown` has colour i of the palette.
struct ShownGroups {
  std::vector<Index> shown;
  std::vector<Index> others;  ///< empty where all are shown

  bool any_others() const { return !others.empty(); }
  std::string others_title() const;  ///< "47 others"
};

inline constexpr std::size_t most_shown_groups = 8;

/// The largest, in their own order.
ShownGroups shown_groups(const Eigen::VectorXd& sizes);

/// The bank's modes that a page tells one by one (told_modes), most used first, as there: the same colours.
ShownGroups shown_modes(const Archive& archive);

}  // namespace modebank::app::report
