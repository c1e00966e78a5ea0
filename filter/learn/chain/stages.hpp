#pragma once

#include <functional>
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

/// The stages of learning: functions of the data, of earlier stages' results and of their inputs struct. They throw
/// ConfigurationError for inputs that do not fit the data, DataError for data that cannot be used.
namespace modebank {

/// The lags and the delay of one linear model of the training runs (ident/lag/structure_search.hpp).
FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Progress& progress);
/// The options with that structure, which stays one that is searched for.
LearningOptions with_structure(const LearningOptions& of, const FoundStructure& found);

MixtureResult cluster(const Recording& recording, const WindowFits& windows, const MixtureInputs& inputs,
                      const Progress& progress);

/// The global model of the windows in linear terms, whatever they were fitted with.
GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const FitOptions& window);

/// One linear model of the training runs.
struct OneModel {
  std::string model;  ///< the windows', if it has their lags
  LinearStructure structure;
  GlobalModel global;
};
/// With these lags; empty: the windows'. `motion`: the model that the windows were fitted with, null for linear ones.
OneModel one_model(const Recording& recording, const WindowFits& windows, const MotionModel* motion,
                   const std::optional<Lags>& lags);

/// The baseline: one Kalman filter on the global model. `filter`: that runs competitors.
Bank learn_single_filter(const Recording& recording, const OneModel& of, const FilterOptions& filter,
                         const Progress& progress);

CompetitorsPart learn_competitors(const Recording& recording, const WindowFits& windows, const MotionModel* motion,
                                  const CompetitorInputs& inputs, const Progress& progress);

/// What a bank is learned from.
struct LearnedFrom {
  const Recording& recording;
  const WindowFits& windows;
  const MixtureResult& mixture;
  const Bank& baseline;
  const MotionModel* motion = nullptr;  ///< that the windows were fitted with; null for linear ones
};

/// The bank, refined if the options say so.
Refinement learn_modes(const LearnedFrom& from, const BankInputs& inputs, const Progress& progress);

/// The competitor that is learned as the bank, with one theta, and from the bank's noises, too.
Refinement learn_one_motion(const LearnedFrom& from, const Bank& bank, const BankInputs& inputs,
                            const Progress& progress);

/// What a limit on the number of modes cost: the same bank is learned without it.
std::vector<MergingCost> merging_of(const LearnedFrom& from, const BankInputs& inputs, const Bank& limited);

/// Scores of bank, competitors and all combined on the training runs, each run by filters that were learned without
/// it; empty where nothing was left out. `of_splits`: of bank and one_motion, the others are learned anew.
std::vector<LeftOutRow> score_left_out(const Recording& recording, const CompetitorsPart& learned,
                                       const BankInputs& inputs,
                                       const std::vector<std::pair<std::string, std::vector<Bank>>>& of_splits,
                                       const Progress& progress);

}  // namespace modebank
