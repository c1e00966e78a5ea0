#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/learn/chain/inputs.hpp"
#include "filter/learn/left_out/folds.hpp"

/// Cross-validation of the chain: banks learned as `run` learns them without some training runs, and what they predict
/// of these.
namespace modebank {

/// Predictions of the samples of one run while it was left out.
struct LeftOutRun {
  Eigen::VectorXd time_s;       ///< N, increasing
  Eigen::VectorXd one_step;     ///< N, log density [nats] one sample ahead; NaN where there is none
  Eigen::VectorXd common_step;  ///< N, the same `ahead` samples ahead; empty where none was asked for
  std::string run = {};
};

/// Learns a bank from the training part of each split and predicts the runs left out with it; of each split its runs,
/// in their order. `filter`: that predicts. `ahead`: samples of common_step, 0: none. The same for any number of
/// threads; throws what the stages throw.
std::vector<std::vector<LeftOutRun>> predict_left_out(const std::vector<ValidationSplit>& splits,
                                                      const LearningInputs& inputs, const FilterOptions& filter,
                                                      Index ahead);

}  // namespace modebank
