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

/// The data of one split for fits.
struct SplitData {
  ValidationSplit runs;
  Bank frame;                       ///< RefineInput::frame, with a noise factor of these training runs
  TrainingTransitions transitions;  ///< of runs.training
  GlobalModel global;               ///< global model of the split's training transitions
};

std::vector<SplitData> split_data(const RefineInput& in);
/// The prior from the split's training runs.
SwitchingPrior prior_of_split(const RefineInput& in, const SplitData& split, double noise_transitions);
SwitchingPrior prior_of_split(const RefineInput& in, const SplitData& split, const RefineStart& start);

/// The fits from one start: one per split, with the prior of that split, iteration by iteration. Holds references to
/// its inputs.
class SplitFits {
 public:
  SplitFits(const RefineInput& in, const std::vector<SplitData>& splits, const RefineStart& start);
  /// Fits with a prior and a start per split.
  SplitFits(const RefineInput& in, const std::vector<SplitData>& splits, std::vector<SwitchingPrior> priors,
            std::vector<SwitchingRegression> starts);

  /// Continues to this total number of iterations, or fewer if the objective converges.
  void advance_to(Index iterations);
  /// Whether all fits have converged.
  bool converged() const;
  std::vector<Bank> banks() const;

 private:
  const std::vector<SplitData>& splits_;
  std::vector<SwitchingPrior> priors_;
  std::vector<std::unique_ptr<ExpectationMaximisation>> fits_;
  Index done_ = 0;
};

}  // namespace modebank
