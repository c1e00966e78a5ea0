#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/decide/calibration.hpp"
#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/score/statistics.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Statistics of the samples of one row.
struct Collected {
  Eigen::Index samples = 0, entropy_samples = 0, failed = 0;  ///< failed: samples without a density above zero
  double usage = 0.0, entropy = 0.0, visits = 0.0, visited = 0.0;
  BandCounts counts;
  SquaredDistances nees;
  SeriesByRun z;  ///< only for the whole filter: one series per run and measured signal
  std::vector<double> whiteness;
  Eigen::VectorXd squared_state_error;
  Eigen::Index state_errors = 0;
};

/// Collects the samples of the runs of a role for one filter (mode -1) or one of its modes. A sample belongs to the
/// mode that was most probable before the measurement. `scores`: scores of all evaluations. `nees_states`: the states
/// of the NEES.
Collected collect(const Bank& bank, Eigen::Index mode, Role role, bool chi_square_nis,
                  const std::vector<Eigen::Index>& nees_states, const std::vector<Trajectory>& runs,
                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores);

}  // namespace modebank
