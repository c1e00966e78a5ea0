#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter/judge/combination.hpp"
#include "filter/judge/scores.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/bank.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/lag/structure.hpp"
#include "mixture/select.hpp"

/// The results of each stage of learning. A result is absent if its stage did not run.
namespace modebank {

struct StructurePart {
  std::optional<FoundStructure> structure;  ///< result of the search for lags; absent without a search
};

struct WindowsPart {
  std::optional<WindowFits> windows;
};

struct MixturePart {
  std::optional<MixtureResult> mixture;
};

struct CompetitorsPart {
  std::optional<Bank> baseline;        ///< one Kalman filter
  std::optional<Bank> noise_only;      ///< one motion; only its noise switches
  std::optional<Bank> nonlinear = {};  ///< one nonlinear motion; empty if no term gains on the training runs
};

struct BankPart {
  std::optional<Bank> bank;
  std::optional<Bank> one_motion;  ///< `one_motion`: learned like the bank, with one theta
  std::optional<Bank> drifting;    ///< one linear motion whose coefficients drift, with running noise that has the
                                   ///< noise levels of `one_motion`
  std::optional<Bank> unrefined;   ///< the bank before expectation-maximisation
  MeasuredFit measured_fit = MeasuredFit::none;
  Index learned_transitions = 0;  ///< number of transitions that refined the bank; 0 means all training transitions
  std::vector<LeftOutRow> left_out = {};  ///< present if filters were learned without some of the training runs
};

/// All results of learning from runs.
struct Learning : StructurePart, WindowsPart, MixturePart, CompetitorsPart, BankPart {
  bool terms_asked = false;  ///< whether terms of `nonlinear` were searched, even if none gained

  /// The bank of the filter with this name, if it exists. For the combination, its combined_frame.
  std::optional<Bank> bank_of(const std::string& filter) const;
};

/// A learned filter with the options to run it.
struct LearnedFilter {
  std::string name;
  Bank bank;
  FilterOptions options;
};

/// The bank and those competitors that exist. `options`: of the bank's filter.
std::vector<LearnedFilter> learned_filters(const Learning& learned, const FilterOptions& options);

}  // namespace modebank
