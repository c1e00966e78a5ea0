#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank::app::report {

/// A mode of one bank and the one of another that is most like it.
struct MatchedMode {
  Eigen::Index first = -1, second = -1;  ///< -1: the other bank has one mode fewer
  Eigen::VectorXd z;      ///< per parameter: difference over the root of both squared standard errors; empty unmatched
  double distance = 0.0;  ///< root mean square of z

  /// All parameters agree at 95 % together (Bonferroni).
  bool agree() const;
};

struct ModeMatch {
  std::vector<MatchedMode> modes;  ///< the first bank's in order, then those that only the second has
  std::string difference;          ///< why modes cannot be matched, in words; empty: they are
};

/// One to one, such that the sum of log(1 + distance^2) is least: near ones decide, whatever the far ones are. Where a
/// standard error is not stated the spread over the mode's windows stands for it, else the parameter does not count.
ModeMatch match_modes(const Bank& first, const Bank& second);

}  // namespace modebank::app::report
