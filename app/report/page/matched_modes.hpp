#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank::app::report {

/// A mode of one bank and the one of another that it is matched with.
struct MatchedMode {
  Eigen::Index first = -1, second = -1;  ///< -1: none
  Eigen::VectorXd
      z;  ///< per parameter: difference over the root of both squared standard errors; empty: not comparable
  double distance = 0.0;                                     ///< root mean square of z
  double shared = std::numeric_limits<double>::quiet_NaN();  ///< their time in common, 0 to 1

  /// All parameters agree at 95 % together (Bonferroni).
  bool agree() const;
};

struct ModeMatch {
  std::vector<MatchedMode> modes;  ///< the first bank's in order, then those that only the second has
  bool by_time = false;            ///< matched by the time that they share, else by their parameters
  std::string difference;          ///< why parameters cannot be compared, in words; empty: they can
};

/// One to one. `shared`: K x L, the time in common of mode a of the first and mode b of the second (time_in_common).
/// The sum over the pairs is largest. Two modes are no pair where each has more time in common with another one.
///
/// Where `shared` is empty the parameters decide: the sum of log(1 + distance^2) is least, so that near pairs decide,
/// whatever the far ones are. Where a standard error is not stated the spread over the mode's windows stands for it,
/// else the parameter does not count.
ModeMatch match_modes(const Bank& first, const Bank& second, const Eigen::MatrixXd& shared = {});

}  // namespace modebank::app::report
