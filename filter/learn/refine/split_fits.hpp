#pragma once

#include <memory>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/step/bank.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// One part of the cross-validation as fits see it.
struct SplitData {
  ValidationSplit runs;
  TrainingTransitions transitions;  ///< of runs.training
  GlobalModel global;               ///< of the same
};

std::vector<SplitData> split_data(const RefineInput& in);
/// Of the split's training runs.
SwitchingPrior prior_of_split(const RefineInput& in, const SplitData& split, double noise_transitions);
SwitchingPrior prior_of_split(const RefineInput& in, const SplitData& split, const RefineStart& start);

/// The fits from one start, one on every split with the prior of that split, iteration by iteration. Keeps references.
class SplitFits {
 public:
  SplitFits(const RefineInput& in, const std::vector<SplitData>& splits, const RefineStart& start);
  /// The same with a prior and a start of each split.
  SplitFits(const RefineInput& in, const std::vector<SplitData>& splits, std::vector<SwitchingPrior> priors,
            std::vector<SwitchingRegression> starts);

  /// Goes on to so many iterations in all, or fewer where the objective stands still.
  void advance_to(Index iterations);
  /// Whether none moves any more.
  bool converged() const;
  std::vector<Bank> banks() const;

 private:
  const RefineInput& in_;
  std::vector<SwitchingPrior> priors_;
  std::vector<std::unique_ptr<ExpectationMaximisation>> fits_;
  Index done_ = 0;
};

}  // namespace modebank
