#pragma once

#include <functional>

#include "filter/learn/chain/stage.hpp"
#include "filter/learn/chain/stages.hpp"

namespace modebank {

/// Hooks of the caller, in addition to runs and options.
struct LearningHooks {
  /// Called for each stage in order, with the inputs of the stage. The hook either calls `compute`, or restores what an
  /// earlier call with equal inputs computed. If empty, stages are always computed.
  std::function<void(Stage, const LearningInputs& inputs, const std::function<void()>& compute)> provide = {};
  const MotionModel* motion = nullptr;  ///< the caller's own motion model; if null, the motion model of window.model is
                                        ///< used, if any
  std::function<void(const Refinement& bank)> refined = {};  ///< called with each refined bank
};

/// Runs the stages in their only order, from runs to a bank: lags and delay, windows, mixture, competitors, bank.
/// `learned` holds the results of earlier calls and receives the new ones. `last`: last stage, at most bank.
/// `one_model`: whether the bank is the baseline. This is set if the time steps differ much. Such steps would make one
/// motion look like several modes. Only least squares then preserves the motion's time constant.
///
/// Throws the errors of the stages (stages.hpp).
void learn_all(const Recording& recording, const LearningOptions& options, Stage last, bool one_model,
               const LearningHooks& hooks, const Progress& progress, Learning& learned);

}  // namespace modebank
