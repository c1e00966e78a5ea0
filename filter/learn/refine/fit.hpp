#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Where a fit begins, and its priors.
struct RefineStart {
  std::string name;
  SwitchingRegression model;
  double noise_transitions = 0.0;
  double theta_transitions = 0.0;  ///< that draw theta towards one motion (switching/shrinkage.hpp)
};

/// The model that refinement has taken so far, whatever was added to it. Each step of refinement takes one and gives
/// one, with the same fit on every split of the cross-validation, by which the rule (left_out/rule.hpp) decides.
struct Fit {
  RefineStart start;
  SwitchingRegression model;         ///< that expectation-maximisation goes on from: the start's, or one with a logit
  GuardPrior guard = {};             ///< of the logit
  std::size_t row = 0;               ///< of the start in the table
  Eigen::Index iterations = 0;       ///< of expectation-maximisation, as the runs left out like them best
  LeftOutScores scores = {};         ///< of the runs left out
  std::vector<Bank> of_splits = {};  ///< the fit without the runs of each split; empty where nothing is left out
  BankDrift drift = {};              ///< of the modes; empty: none
  NoiseAdaptation adaptation = {};   ///< of the filter where modes drift
  // Once expectation-maximisation on all training runs is through:
  Bank bank = {};
  SwitchingPrior prior = {};
  bool R_estimated = false;
};

}  // namespace modebank
