#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/learn/chain/options.hpp"

/// The inputs of each stage of learning. The key of a stored stage is made from its struct, field by field. So a stage
/// cannot depend on anything outside its key.
namespace modebank {

struct WindowInputs {
  FitOptions window;  ///< window options with the chain's seed
};

struct MixtureInputs {
  FitOptions window;  ///< needed to fit the same windows with one lag
  ClusterOptions mixture;
  std::uint64_t seed = 1;
};

/// The linear stage's structure, and R where the configuration states it.
struct SingleModel {
  ArmaxStructure structure;
  std::optional<double> measurement_variance;
};

/// Inputs of the bank's competitors. Except for `one_motion`, competitors depend on the windows alone. `one_motion` has
/// at most as many noise levels as the mixture has components.
struct CompetitorInputs {
  FitOptions window;
  Index transitions = 0;                 ///< largest number of transitions to learn from, as for the bank; 0 takes all
  std::uint64_t seed = 1;                ///< seed that selects these transitions
  std::string terms = "auto";            ///< terms of `nonlinear`
  RefineOptions em = {};                 ///< how `nonlinear` is learned
  std::optional<StageLags> linear = {};  ///< lags of `baseline`, `noise_only` and `nonlinear`; if empty, the lags of
                                         ///< the windows

  /// Needed for the bank, and for all competitors except `baseline`.
  NoiseByInput noise_by_input = NoiseByInput::none;
  std::optional<SingleModel> single = {};  ///< the linear stage's model; empty if `baseline` is least squares
  bool all = true;  ///< if false, only the baseline and the decision about the noise factor are made
};

/// Inputs of the competitor `one_motion`, which is learned like the bank.
struct OneMotionInputs {
  BankOptions bank;
  std::vector<Index> horizon = {};     ///< horizons at which left-out training runs are predicted, in addition to one
                                       ///< sample ahead
  std::optional<StageLags> lags = {};  ///< if empty, the lags of the windows are used
};

/// Inputs of the competitor `drifting`. It has the noise levels of `one_motion`, if that exists.
struct DriftingInputs {
  std::vector<Index> horizon = {};     ///< horizons at which it widens its predictions
  std::optional<StageLags> lags = {};  ///< if empty, the lags of the windows are used
};

struct BankInputs {
  FitOptions window;
  BankOptions bank;        ///< bank options with the chain's seed
  bool one_model = false;  ///< whether the bank is the baseline, because a single Kalman filter was requested
  std::optional<FilterOptions> filter;             ///< set if learning uses the filter, that is for refinement
  std::optional<OneMotionInputs> one_motion = {};  ///< empty for a single Kalman filter
  std::optional<DriftingInputs> drifting = {};     ///< empty if the bank has no competitors but the baseline
  std::optional<SingleModel> single = {};          ///< as in CompetitorInputs
  bool terms_stated = false;  ///< whether the terms of `nonlinear` are given; if not, they are chosen on runs that were
                              ///< left out
};

/// The inputs of the search for a structure.
struct StructureInputs {
  SearchedLags searched;
  FitOptions window;       ///< the given lags, and how a model is fitted; all other fields have default values
  bool with_modes = true;  ///< whether modes, and one motion with switching noise, have a structure of their own
};

/// The inputs of all stages of learning.
struct LearningInputs {
  std::optional<StructureInputs> structure;  ///< empty if no lags are searched
  WindowInputs windows;
  MixtureInputs mixture;
  CompetitorInputs competitors;
  BankInputs bank;
};

/// Filter options of a competitor: its own kind of filter.
FilterOptions competitor_filter(const std::string& name);

/// Splits the options into the inputs of each stage.
LearningInputs learning_inputs(const LearningOptions& options);

}  // namespace modebank
