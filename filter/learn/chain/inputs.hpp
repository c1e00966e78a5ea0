#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "ident/fit/options.hpp"
#include "ident/lag/structure.hpp"
#include "modebank/learn/options.hpp"

/// The options of learning, and the inputs of each stage. The key of a stored stage is made from its struct of inputs,
/// field by field. So a stage cannot depend on anything outside its key.
namespace modebank {

/// The stages from data to scores, in order. Learning comprises structure to bank.
enum class Stage { data, structure, windows, mixture, competitors, bank, competitor_scores, bank_scores };
inline constexpr std::size_t stage_count = 8;

template <>
struct EnumNames<Stage> {
  static constexpr Names<stage_count> values{"data",        "structure", "windows",           "mixture",
                                             "competitors", "bank",      "competitor_scores", "bank_scores"};
};

constexpr std::size_t index_of(Stage stage) { return static_cast<std::size_t>(stage); }

/// Options for evaluating a filter.
struct ScoringOptions {
  static inline const std::vector<Eigen::Index> default_horizon{1, 10};
  std::vector<Eigen::Index> horizon = default_horizon;  ///< in samples; the summary already has horizon 1
  FreeRunOptions free_run = {};                         ///< with the seed of the whole chain
  std::uint64_t seed = 1;  ///< of the transforms of quantised measurements; the seed of the whole chain
};

/// Which options of windows are derived from the data (ident/fit/window_length.hpp).
struct AutomaticWindows {
  bool length = false, step = false, intercept = false;
};

/// Lags and delays of the stages. A stage without an entry has those of the windows.
struct OtherLags {
  std::optional<StageLags> linear = {};  ///< of `baseline`, `noise_only`, `nonlinear` and the search for its terms
  std::optional<StageLags> one_motion = {};
  std::optional<StageLags> drifting = {};
  std::optional<ArmaxStructure> armax = {};  ///< of the linear stage: for `baseline`, in place of `linear`
};

/// All options of learning from runs. `seed` is the only seed: it replaces those in `window` and `bank`.
struct LearningOptions {
  FitOptions window = {};
  ClusterOptions mixture = {};
  BankOptions bank = {};
  FilterOptions filter = {};
  ScoringOptions scoring = {};
  std::uint64_t seed = 1;
  SearchedLags searched_lags = {};          ///< which lags are chosen on left-out runs, in place of those in `window`
  AutomaticWindows automatic_windows = {};  ///< which values are derived from the data, in place of those in `window`
  std::string terms = "auto";               ///< terms of `nonlinear`: auto, none, or a list for read_terms
  OtherLags other_lags = {};
  bool competitors = true;  ///< if false, only the baseline is learned, and the bank is made from it
  /// Whether the bank is the baseline: if the time steps differ much, one motion looks like several modes, and only
  /// least squares preserves its time constant.
  bool one_model = false;
};

struct StructureInputs {
  SearchedLags searched;
  FitOptions window;       ///< the given lags, and how a model is fitted; all other fields have default values
  bool with_modes = true;  ///< whether modes, and one motion with switching noise, have a structure of their own
};

struct MixtureInputs {
  FitOptions window;  ///< needed to fit the same windows with one lag
  ClusterOptions mixture;
  std::uint64_t seed = 1;
};

/// Inputs of the competitors that depend on the windows alone.
struct CompetitorInputs {
  FitOptions window;
  std::string terms = "auto";  ///< terms of `nonlinear`
  RefineOptions em = {};       ///< how `nonlinear` is learned; its part of the runs is that of all competitors
  OtherLags lags = {};
  std::optional<double> measurement_variance = {};  ///< stated R of the linear stage's model
  bool all = true;                                  ///< if false, only the baseline is learned
};

/// Inputs of the bank, and of the competitors `one_motion` and `drifting`, which are learned after it.
struct BankInputs {
  FitOptions window;
  BankOptions bank;  ///< with the chain's seed; also of `one_motion`
  OtherLags lags = {};
  std::vector<Index> horizon = {};  ///< of predictions of left-out training runs, and of the factors of `drifting`
  Index simulate = 0;  ///< measured samples at the start of free runs; 0: none, so theta is of one step ahead
  std::optional<FilterOptions> filter = {};  ///< set if learning uses the filter, that is for refinement
  bool one_model = false;                    ///< whether the bank is the baseline
  bool one_motion = true;                    ///< false for a single Kalman filter
  bool drifting = true;                      ///< false if the bank has no competitors but the baseline
  bool terms_stated = false;  ///< whether the terms of `nonlinear` are given, not chosen on left-out runs
};

struct LearningInputs {
  std::optional<StructureInputs> structure;  ///< empty if no lags are searched
  FitOptions windows;                        ///< with the chain's seed
  MixtureInputs mixture;
  CompetitorInputs competitors;
  BankInputs bank;
};

/// Splits the options into the inputs of each stage.
LearningInputs learning_inputs(const LearningOptions& options);

/// The options with the found structure, marked as the result of a search. `inputs`: number of input channels.
LearningOptions with_structure(const LearningOptions& of, const FoundStructure& found, Index inputs);

/// The structure of a row of the table, with the delays that were found for the inputs.
ArmaxStructure armax_of(const StructureScore& row, const FoundStructure& found, Index inputs, bool intercept);

/// A competitor has its own kind of filter.
FilterOptions competitor_filter(const std::string& name);

/// Throws DataError for a state that is constant in all training runs: any filter predicts it without error.
void refuse_constant_states(const Recording& recording);

/// Throws DataError for a horizon (samples ahead) that is longer than the longest judged run, so that no sample could
/// be scored. Judged are the held-out runs; without them, the training runs.
void refuse_unreached_horizons(const Recording& recording, const std::vector<Index>& horizons);

/// A message about regressors of the linear model that the training runs do not determine; empty if there is none.
std::string unidentifiable_effects(const Recording& recording, const LinearStructure& structure);

}  // namespace modebank
