#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/cli/check/check.hpp"
#include "app/config/chain_options.hpp"
#include "filter/judge/score/paired_gain.hpp"
#include "filter/learn/chain/learn_left_out.hpp"

/// Predictions of training runs that the model was not learned from. They compare configurations on the same samples.
/// Held-out runs are not used.
namespace modebank {

/// The training runs, and the groups of runs that are left out together. If too few runs are usable, `parts` is empty
/// and each run is cut into parts (validation_splits).
struct LeftOutPlan {
  std::vector<std::string> runs;
  std::vector<std::vector<std::string>> parts;
};
LeftOutPlan plan_left_out(const DataCheck& check);

struct LeftOut {
  std::vector<LeftOutRun> runs;  ///< the predicted runs, in the order of the plan
  double period_s = 0.0;         ///< median time between samples
  std::string problem;           ///< reason why no bank was learned; empty if one was
};

/// Leaves out each part in turn, learns a bank from the other training runs as `run` does, and predicts the part. Lags
/// are estimated anew each time. For a comparison of different rates, `common_s` is the length of the predictions. The
/// result does not depend on the number of threads.
LeftOut predict_left_out(const ChainOptions& options, const LeftOutPlan& plan, double common_s);

/// Gain of `better` over `other`. At equal rates, it compares predictions one step ahead on the samples that both have.
/// At different rates, it compares predictions of equal length. Each sample of the slower rate is then paired with the
/// nearest sample of the faster rate. NaN if fewer than half of the samples have a partner.
PairedGain compare_left_out(const LeftOut& better, const LeftOut& other);

}  // namespace modebank
