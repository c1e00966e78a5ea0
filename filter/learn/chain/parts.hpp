#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter/judge/score/combination.hpp"
#include "filter/judge/score/scores.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/bank.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/lag/structure.hpp"
#include "mixture/select.hpp"

/// The results of each stage of learning; absent stages did not run.
namespace modebank {

struct StructurePart {
  std::optional<FoundStructure> structure;  ///< where lags were searched for
};

struct WindowsPart {
  std::optional<WindowFits> windows;
};

struct MixturePart {
  std::optional<MixtureResult> mixture;
};

struct CompetitorsPart {
  std::optional<Bank> baseline;        ///< one Kalman filter
  std::optional<Bank> noise_only;      ///< switches noise alone
  std::optional<Bank> drifting;        ///< one linear motion whose coefficients wander, with running noise
  std::optional<Bank> nonlinear = {};  ///< one motion that bends; empty where no term gains on the training runs
};

struct BankPart {
  std::optional<Bank> bank;
  std::optional<Bank> one_motion;  ///< the competitor that is learned as the bank, with one theta
  std::optional<Bank> unrefined;   ///< the bank that expectation-maximisation started from
  MeasuredFit measured_fit = MeasuredFit::none;
  Index learned_transitions = 0;          ///< that the bank was refined on; 0: all of the training runs'
  std::vector<LeftOutRow> left_out = {};  ///< where filters were learned without some training runs
  std::vector<MergingCost> merging = {};  ///< with bank.modes, where components were merged
};

/// All that was learned from runs.
struct Learning : StructurePart, WindowsPart, MixturePart, CompetitorsPart, BankPart {
  bool terms_asked = false;  ///< for nonlinear, whether or not any gained

  /// By the name of its filter, where there is one; of all combined their combined_frame.
  std::optional<Bank> bank_of(const std::string& filter) const;
};

}  // namespace modebank
