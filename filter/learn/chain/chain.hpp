#pragma once

#include <functional>

#include "filter/learn/chain/stage.hpp"
#include "filter/learn/chain/stages.hpp"

namespace modebank {

/// Callers' part in learning beside runs and options.
struct LearningHooks {
  /// Called for each stage, in their order, with the inputs that it is given: calls `compute`, or puts what an earlier
  /// call with equal inputs computed in place. Empty: computes.
  std::function<void(Stage, const LearningInputs& inputs, const std::function<void()>& compute)> provide = {};
  const MotionModel* motion = nullptr;  ///< of the caller's own; null: that of window.model, if it is one
  std::function<void(const Refinement& bank)> refined = {};  ///< hears how the bank was refined
};

/// The one order of stages from runs to a bank: lags and delay, windows, mixture, competitors, bank. `learned` holds
/// what earlier calls left, and gets what is learned. `one_model`: steps of many lengths make modes of one motion, and
/// least squares alone keeps its time constant: the bank is the baseline's. `last`: not past bank.
///
/// Throws what the stages throw (stages.hpp).
void learn_all(const Recording& recording, const LearningOptions& options, Stage last, bool one_model,
               const LearningHooks& hooks, const Progress& progress, Learning& learned);

}  // namespace modebank
