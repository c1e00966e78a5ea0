#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/cli/check/check.hpp"
#include "app/config/chain_options.hpp"
#include "filter/judge/score/paired_gain.hpp"
#include "filter/learn/chain/learn_left_out.hpp"

/// What configurations predict of training runs that were left out, so that two of them can be compared on the same
/// samples. Runs that are held out take no part.
namespace modebank {

/// The training runs, and which of them are left out together; without parts too few can be used to leave whole runs
/// out, and each is cut into stretches (validation_splits).
struct LeftOutPlan {
  std::vector<std::string> runs;
  std::vector<std::vector<std::string>> parts;
};
LeftOutPlan plan_left_out(const DataCheck& check);

struct LeftOut {
  std::vector<LeftOutRun> runs;  ///< in the plan's order
  double period_s = 0.0;         ///< median between samples
  std::string problem;           ///< why nothing was learned; empty: something was
};

/// Learns a bank as `run` does from the other training runs of each part in turn, and predicts those left out. Lags are
/// estimated anew without them. `common_s`: how long ahead predictions are made in common with configurations of
/// another rate. The same for any number of threads.
LeftOut predict_left_out(const ChainOptions& options, const LeftOutPlan& plan, double common_s);

/// What `better` gains over `other`. At the same rate: of predictions one sample ahead, on the samples that both have.
/// At two rates: of predictions made equally long ahead of the slower one's samples, each beside the nearest of the
/// faster one. The gain is NaN where fewer than half of the samples have a counterpart.
PairedGain compare_left_out(const LeftOut& better, const LeftOut& other);

}  // namespace modebank
