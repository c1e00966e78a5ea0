#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/learn/chain/options.hpp"

/// The options that each stage of learning gets, and all that it gets: a stored stage's key is made of its struct,
/// field by field, so that no stage can depend on what its key does not hold.
namespace modebank {

struct WindowInputs {
  FitOptions window;  ///< with the chain's seed
};

struct MixtureInputs {
  FitOptions window;  ///< for fits of the same windows with one lag
  ClusterOptions mixture;
  std::uint64_t seed = 1;
};

/// The bank's competitors: all but one_motion depend on the windows alone, which has as many noise levels at most as
/// the mixture has components.
struct CompetitorInputs {
  FitOptions window;
  FilterOptions filter;                              ///< that runs competitors, for the noise scale's memory
  std::vector<Index> horizon;                        ///< that drifting is to widen its predictions for
  Index transitions = 0;                             ///< that they learn from at most, as the bank does; 0: from all
  std::uint64_t seed = 1;                            ///< which these are
  std::string terms = "auto";                        ///< of nonlinear
  RefineOptions em = {};                             ///< how that is learned
  std::optional<Lags> linear = {};                   ///< of baseline, noise_only and nonlinear; empty: the windows'
  std::optional<Lags> drifting = {};                 ///< of drifting; empty: the windows'
  NoiseByInput noise_by_input = NoiseByInput::none;  ///< of all but baseline and drifting, and of the bank
  bool all = true;                                   ///< false: baseline and the question on noise alone
};

/// How the competitor one_motion is learned: as the bank.
struct OneMotionInputs {
  BankOptions bank;
  FilterOptions filter;             ///< that runs it
  std::vector<Index> horizon = {};  ///< that left-out training runs are predicted for, beside one sample ahead
  std::optional<Lags> lags = {};    ///< empty: the windows'
};

struct BankInputs {
  FitOptions window;
  BankOptions bank;                     ///< with the chain's seed
  bool one_model = false;               ///< the bank is the baseline: a single Kalman filter was asked for
  std::optional<FilterOptions> filter;  ///< where learning runs the filter: refinement, and what merging modes costs
  std::optional<OneMotionInputs> one_motion = {};  ///< empty: a single Kalman filter has no use for it
  bool terms_stated = false;                       ///< runs left out choose no terms of nonlinear
};

/// The inputs of the search for a structure.
struct StructureInputs {
  SearchedLags searched;
  FitOptions window;       ///< the lags that are not searched for, and how a model is fitted; the rest as by default
  bool with_modes = true;  ///< whether modes, and one motion whose noise switches, choose for themselves
};

/// The inputs of all stages of learning.
struct LearningInputs {
  std::optional<StructureInputs> structure;  ///< empty where nothing is searched for
  WindowInputs windows;
  MixtureInputs mixture;
  CompetitorInputs competitors;
  BankInputs bank;
};

/// How a competitor steps: by its own kind of filter, with the bank's noise and time steps.
FilterOptions competitor_filter(const std::string& name, const FilterOptions& of_bank);

/// Parts the options into what each stage needs.
LearningInputs learning_inputs(const LearningOptions& options);

}  // namespace modebank
