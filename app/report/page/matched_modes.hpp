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
  Eigen::VectorXd
      z;  ///< per parameter: difference over the root of the sum of squared standard errors; empty: not comparable
  double distance = 0.0;                                     ///< root mean square of z
  double shared = std::numeric_limits<double>::quiet_NaN();  ///< share of their time in common, 0 to 1

  /// Whether all parameters agree jointly at 95 % (Bonferroni).
  bool agree() const;
};

struct ModeMatch {
  std::vector<MatchedMode> modes;  ///< modes of the first bank in order, then the unmatched ones of the second
  bool by_time = false;            ///< matched by common time, otherwise by parameters
  std::string difference;          ///< reason why parameters cannot be compared; empty if they can
};

/// Matches modes one to one such that the sum of `shared` over the pairs is largest. `shared`: K x L, the time in
/// common of mode a of the first and mode b of the second bank (time_in_common). Two modes are not paired if each has
/// more time in common with another one.
///
/// If `shared` is empty, the parameters are used: the sum of log(1 + distance^2) is smallest, so that near pairs count
/// more than far ones. A missing standard error is replaced by the standard deviation over the mode's windows; without
/// that the parameter is ignored.
ModeMatch match_modes(const Bank& first, const Bank& second, const Eigen::MatrixXd& shared = {});

}  // namespace modebank::app::report
