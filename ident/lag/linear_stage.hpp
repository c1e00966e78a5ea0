#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ident/lag/armax.hpp"

namespace modebank {

/// One linear model of the training runs, with the evidence for its structure.
struct LinearStage {
  std::vector<ArmaxFit> candidates;  ///< empty where the data are too few or a state never moves
  std::size_t best = 0, chosen = 0;
  Eigen::VectorXd rows;  ///< rows of each part that is left out
  bool by_runs = false;  ///< true: the parts are whole runs; false: stretches of runs

  const ArmaxFit& fit() const { return candidates[chosen]; }
};

struct LinearStageOptions {
  std::optional<ArmaxStructure> only = {};  ///< the one candidate, if nothing is searched
  bool intercept = true;                    ///< whether levels have a constant
  std::vector<Index> least_delay = {};      ///< m, smallest delay of each input; empty: 1 for all
};

/// Finds each input's delay, then again by the likelihood of the chosen structure. Compares ARMAX and ARX structures in
/// levels and in differences on the same rows of left-out parts. Chooses the fewest parameters within one standard
/// error, 0.001 nats a row, or 6 nats per state in all, whichever is largest. The result does not depend on the number
/// of threads.
LinearStage find_linear_stage(const Recording& recording, const LinearStageOptions& options = {});

/// Variances of the measurement noise v and of the process noise w, n each.
struct NoiseVariances {
  Eigen::VectorXd R, Q;
  Eigen::VectorXd R_error;  ///< standard errors, zero where R is stated
};

/// R and Q by non-negative least squares on the autocovariances of C(q) e = w + A(q) v. A stated R is held.
NoiseVariances noise_variances(const ArmaxFit& fit, const std::optional<Eigen::VectorXd>& stated_R = std::nullopt);

}  // namespace modebank
