#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank::app::report {

/// A mode of one bank and its match in another.
struct MatchedMode {
  Eigen::Index first = -1, second = -1;  ///< -1: none
  Eigen::VectorXd z;  ///< per parameter: difference divided by the root of the sum of squared standard errors; empty:
                      ///< not comparable
  double distance = 0.0;                                     ///< root mean square of z
  double shared = std::numeric_limits<double>::quiet_NaN();  ///< share of time in common, 0 to 1

  /// Whether all parameters agree jointly at 95 % (Bonferroni).
  bool agree() const;
};

struct ModeMatch {
  std::vector<MatchedMode> modes;  ///< modes of the first bank in order, then the unmatched ones of the second
  bool by_time = false;            ///< matched by common time, otherwise by parameters
  std::string difference;          ///< reason why parameters cannot be compared; empty if they can
};

/// Matches modes one to one so that the sum of `shared` over all pairs is largest. `shared` (K x L) is the common time
/// of mode a of the first bank and mode b of the second (time_in_common). Two modes stay unmatched if each has more
/// time in common with another mode.
///
/// If `shared` is empty, the parameters decide: the sum of log(1 + distance^2) is smallest, so that near pairs count
/// more than far ones. A missing standard error is replaced by the standard deviation over the mode's windows. Without
/// this deviation the parameter is ignored.
ModeMatch match_modes(const Bank& first, const Bank& second, const Eigen::MatrixXd& shared = {});

}  // namespace modebank::app::report
