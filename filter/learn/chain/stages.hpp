#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "filter/learn/chain/inputs.hpp"
#include "filter/learn/chain/parts.hpp"
#include "filter/learn/chain/progress.hpp"
#include "filter/learn/learn.hpp"
#include "ident/data/trajectory.hpp"
#include "mixture/features.hpp"

/// The stages of learning. Each is a function of the data, of earlier results and of its inputs struct. Throws
/// ConfigurationError for inputs that do not fit the data, and DataError for unusable data.
namespace modebank {

/// The lags and the delay of one linear model of the training runs (ident/lag/structure_search.hpp).
FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Progress& progress);
/// The options with the found structure, marked as the result of a search.
LearningOptions with_structure(const LearningOptions& of, const FoundStructure& found, Index inputs);

/// The global model of the windows in linear form, for linear and motion models.
GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const FitOptions& window);

/// One linear model of the training runs.
struct OneModel {
  std::string model;  ///< name of the windows' model, if that model has these lags
  LinearStructure structure;
  GlobalModel global;
};
/// Fits one model with these lags. If no lags are given, uses those of the windows. `motion`: motion model of the
/// windows, null for linear models.
OneModel one_model(const Recording& recording, const WindowFits& windows, const MotionModel* motion,
                   const std::optional<StageLags>& lags);

/// The baseline of the linear stage; empty where the training runs are too short for it.
std::optional<Bank> learn_single(const Recording& recording, const SingleModel& single);
/// The baseline: that of the linear stage, or one Kalman filter on the global model.
Bank learn_single_filter(const Recording& recording, const OneModel& of, const CompetitorInputs& inputs,
                         const Progress& progress);

CompetitorsPart learn_competitors(const Recording& recording, const WindowFits& windows, const MotionModel* motion,
                                  const CompetitorInputs& inputs, const Progress& progress);

/// Inputs for learning a bank.
struct LearnedFrom {
  const Recording& recording;
  const WindowFits& windows;
  const MixtureResult& mixture;
  const Bank& baseline;
  const MotionModel* motion = nullptr;  ///< motion model of the windows; null for linear models
};

/// Learns the bank, and refines it if the options require.
Refinement learn_modes(const LearnedFrom& from, const BankInputs& inputs, const Progress& progress);

/// Learns the competitor one_motion. It is learned like the bank but with one theta, and also starts from the noises of
/// the bank.
Refinement learn_one_motion(const LearnedFrom& from, const Bank& bank, const BankInputs& inputs,
                            const Progress& progress);

/// Learns the competitor drifting, with the noise levels of `one_motion` if it is there.
Bank learn_drifting(const LearnedFrom& from, const std::optional<Bank>& one_motion, const BankInputs& inputs,
                    const Progress& progress);

/// Scores of bank, competitors and their combination on the training runs. Each run is scored by filters learned
/// without it. Empty if no run was left out. `of_splits`: banks and `one_motion` of each split. The other filters are
/// learned here.
std::vector<LeftOutRow> score_left_out(const Recording& recording, const Learning& learned, const BankInputs& inputs,
                                       const std::vector<std::pair<std::string, std::vector<Bank>>>& of_splits,
                                       const Progress& progress);

}  // namespace modebank
