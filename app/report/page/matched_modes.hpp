#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank::app::report {

/// A mode of one bank and the matching mode of another bank.
struct MatchedMode {
  Eigen::Index first = -1, second = -1;  ///< -1: none
  Eigen::VectorXd z;  ///< per parameter: difference divided by its standard error, the root of the sum of both squared
                      ///< errors; empty if the modes cannot be compared
  double distance = 0.0;                                     ///< root mean square of z
  double shared = std::numeric_limits<double>::quiet_NaN();  ///< share of time that both modes have in common, 0 to 1

  /// Whether all parameters agree, by a joint test at 95 % (Bonferroni).
  bool agree() const;
};

struct ModeMatch {
  std::vector<MatchedMode> modes;  ///< modes of the first bank in order, then the unmatched modes of the second bank
  bool by_time = false;            ///< true if the match is by common time, false if by parameters
  std::string difference;          ///< reason why parameters cannot be compared; empty if they can
};

/// Matches modes one to one so that the sum of `shared` over all pairs is largest. `shared` (K x L) is the common time
/// of mode a of the first bank and mode b of the second bank (time_in_common). A pair is separated if each of its modes
/// has more time in common with another mode.
///
/// If `shared` is empty, the parameters decide. Then the sum of log(1 + distance^2) over all pairs is smallest, so that
/// near pairs count more than distant pairs. A missing standard error is replaced by the standard deviation over the
/// mode's windows. A parameter without this deviation is ignored.
ModeMatch match_modes(const Bank& first, const Bank& second, const Eigen::MatrixXd& shared = {});

}  // namespace modebank::app::report
