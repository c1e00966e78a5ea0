#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/cli/check/check.hpp"
#include "app/config/chain_options.hpp"
#include "filter/judge/score/paired_gain.hpp"
#include "filter/learn/chain/learn_left_out.hpp"

/// Predictions of left-out training runs, for a comparison of configurations on the same samples. Held-out runs are not
/// used.
namespace modebank {

/// The training runs, and the groups of runs that are left out together. If too few runs are usable, parts is empty and
/// each run is cut into parts (validation_splits).
struct LeftOutPlan {
  std::vector<std::string> runs;
  std::vector<std::vector<std::string>> parts;
};
LeftOutPlan plan_left_out(const DataCheck& check);

struct LeftOut {
  std::vector<LeftOutRun> runs;  ///< in the order of the plan
  double period_s = 0.0;         ///< median between samples
  std::string problem;           ///< reason why no bank was learned; else empty
};

/// Leaves out each part in turn, learns a bank from the other training runs as `run` does, and predicts the part. Lags
/// are estimated anew each time. `common_s` is the length of the predictions for comparisons at different rates. The
/// result does not depend on the number of threads.
LeftOut predict_left_out(const ChainOptions& options, const LeftOutPlan& plan, double common_s);

/// Gain of `better` over `other`. At equal rates it compares predictions one step ahead, on the samples in both. At two
/// rates it compares predictions of equal length: each sample of the slower rate with the nearest of the faster one.
/// NaN if fewer than half of the samples have a counterpart.
PairedGain compare_left_out(const LeftOut& better, const LeftOut& other);

}  // namespace modebank
