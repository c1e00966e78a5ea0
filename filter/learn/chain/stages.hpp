#pragma once

#include <optional>
#include <vector>

#include "filter/learn/chain/chain.hpp"
#include "ident/lag/linear_stage.hpp"

/// The stages of learning. Each is a function of the data, of earlier results and of its inputs struct. Throws
/// ConfigurationError for inputs that do not fit the data, and DataError for unusable data.
namespace modebank {

/// What every stage takes.
struct StageData {
  const Recording& recording;
  const Recording& part;      ///< the part of the training runs that filters learn from (left_out/folds.hpp)
  const MotionModel* motion;  ///< motion model of the windows; null for linear models
  const Tell& tell;
};

/// The lags and the delay of one linear model of the training runs (ident/lag), and of the stages.
FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Tell& tell);

/// Chooses a structure for each stage among the structures that were compared. A linear model needs additional lags if
/// the motion is nonlinear or switches. Models that are nonlinear or switch themselves predict worse with these lags.
/// Marks rows of the table. Adds rows that are tested only here: one lag and two lags, with the found delay and with a
/// delay of one sample.
///
/// - One linear motion: takes the result of the search.
/// - `drifting`: decides by the causal score of a model with drifting coefficients. (The search's one-standard-error
///   rule is unstable over a few, different runs.) The condition is that this model predicts the training runs better
///   than the constant model, by 0.02 nats per sample. Candidates are the finalists of the search, and equal state and
///   input lags from 1 to 8. The fewest lags within 0.001 nats per sample (or 6 nats in all) of the highest score are
///   taken. With more than 20,000 training transitions the result of the search is kept.
/// - Modes, and one motion with switching noise: take the result of the search, unless one lag, two lags or the lags
///   of `drifting` gain (compare_structures).
void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found);

/// `own`: the caller's own motion model; null for the model that the options name.
WindowFits identify_windows(const StageData& data, const FitOptions& window, const MotionModel* own);

MixtureResult cluster(const StageData& data, const WindowFits& windows, const MixtureInputs& inputs);

/// The baseline: that of the linear stage, or one Kalman filter on the global model.
Bank learn_single_filter(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs);

CompetitorsPart learn_competitors(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs);

/// Learns the bank, and refines it if the options require.
Refinement learn_modes(const StageData& data, const Learning& learned, const BankInputs& inputs);

/// Learns the competitor one_motion. It is learned like the bank but with one theta, and also starts from the noises of
/// the bank.
Refinement learn_one_motion(const StageData& data, const Learning& learned, const BankInputs& inputs);

/// Learns the competitor drifting, with the noise levels of `one_motion` if it is there.
Bank learn_drifting(const StageData& data, const Learning& learned, const BankInputs& inputs);

/// Scores of bank, competitors and their combination on the training runs. Each run is scored by filters learned
/// without it. Empty if no run was left out. `banks`, `one_motions`: of each split; the other filters are learned here.
std::vector<LeftOutRow> score_left_out(const StageData& data, const Learning& learned, const BankInputs& inputs,
                                       const std::vector<Bank>& banks, const std::vector<Bank>& one_motions);

/// One Kalman filter with theta, Q and R of the linear stage. Differences become levels with a pole at 1 and without a
/// constant. `variance`: stated R of every state.
Bank bank_of(const Recording& recording, const ArmaxFit& fit, std::optional<double> variance);

/// bank_of the fit of this structure to the training runs; empty where the runs are too short for it.
std::optional<Bank> learn_armax(const Recording& recording, const ArmaxStructure& structure,
                                std::optional<double> variance);

}  // namespace modebank
