#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/learn/chain/inputs.hpp"
#include "filter/learn/left_out/folds.hpp"

/// Cross-validation of the chain: learns banks in the same way as `run`, without some training runs, and predicts those
/// runs.
namespace modebank {

/// Predictions of one run by a bank that was learned without it.
struct LeftOutRun {
  Eigen::VectorXd time_s;       ///< N, increasing
  Eigen::VectorXd one_step;     ///< N, log density [nats] one sample ahead; NaN where it does not exist
  Eigen::VectorXd common_step;  ///< N, log density `ahead` samples ahead; empty if not requested
  std::string run = {};
};

/// Learns a bank from the training part of each split, and uses this bank to predict the left-out runs of the split.
/// Returns the runs of each split in order. `filter`: filter for the predictions. `ahead`: a further horizon, for
/// common_step; 0 means none. The result is the same for any number of threads. Throws the errors of the stages.
std::vector<std::vector<LeftOutRun>> predict_left_out(const std::vector<ValidationSplit>& splits,
                                                      const LearningInputs& inputs, const FilterOptions& filter,
                                                      Index ahead);

}  // namespace modebank
