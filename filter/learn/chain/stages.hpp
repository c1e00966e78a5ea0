#pragma once

#include "filter/learn/chain/chain.hpp"

/// The stages of learning: functions of the data, of earlier results and of their inputs, which throw as learn_all.
namespace modebank {

struct StageData {
  const Recording& recording;
  const Recording& part;      ///< the part of the training runs that filters learn from (left_out/folds.hpp)
  const MotionModel* motion;  ///< motion model of the windows; null for linear models
  const Tell& tell;
};

/// The lags and the delay of one linear model of the training runs (ident/lag), and of the stages.
///
/// One linear model needs additional lags if the motion is nonlinear or switches. Models that do so themselves predict
/// worse with these lags. So stages choose:
/// - `drifting`: among the finalists of the search and equal state and input lags from 1 to 8, by its own causal score.
///   (The search's one-standard-error rule is unstable over a few, different runs.) It takes the fewest lags within
///   0.001 nats per sample (or 6 nats in all) of the highest score, if it predicts the training runs by 0.02 nats per
///   sample better than the constant model, and if they have at most 20,000 transitions.
/// - Modes, and one motion with switching noise: the result of the search, unless 1, 2, 3, 4 or 6 equal lags (with the
///   found delay or one of one sample) or the lags of `drifting` gain (compare_structures). With a noisy sensor, which
///   lags of exact states imitate, the result of the search.
FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Tell& tell);

/// The choices of the stages, among the rows of `found` and those that are tested only here, which are added.
void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found);

/// `own`: the caller's own motion model; null for the model that the options name.
WindowFits identify_windows(const StageData& data, const FitOptions& window, const MotionModel* own);

MixtureResult cluster(const StageData& data, const WindowFits& windows, const MixtureInputs& inputs);

/// The baseline: that of the linear stage, or one Kalman filter on the global model.
Bank learn_single_filter(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs);

CompetitorsPart learn_competitors(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs);

/// The bank, refined if the options require.
Refinement learn_modes(const StageData& data, const Learning& learned, const BankInputs& inputs);

/// The competitor one_motion: learned like the bank, but with one theta, and also from the noises of the bank.
Refinement learn_one_motion(const StageData& data, const Learning& learned, const BankInputs& inputs);

/// The competitor drifting, with the noise levels of `one_motion` if it is there. Where the level wanders (the linear
/// stage takes differences) it has a constant, which drifts like the other coefficients.
Bank learn_drifting(const StageData& data, const Learning& learned, const BankInputs& inputs);

/// Scores of all filters on the training runs, each by filters learned without the scored run. Empty if no run was left
/// out. `banks`, `one_motions`: of each split; the other filters are learned here.
std::vector<LeftOutRow> score_left_out(const StageData& data, const Learning& learned, const BankInputs& inputs,
                                       const std::vector<Bank>& banks, const std::vector<Bank>& one_motions);

}  // namespace modebank
