#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Start of a fit, and its priors.
struct RefineStart {
  std::string name;
  SwitchingRegression model;
  double noise_transitions = 0.0;
  double theta_transitions = 0.0;  ///< weight of the prior towards one motion, in transitions (switching/starts.hpp)
};

/// The model accepted so far, with all additions. Each refinement step takes a Fit and returns a Fit. A Fit also
/// contains the fit to the training part of every split of the cross-validation. The rule (left_out/rule.hpp) decides
/// by these fits.
struct Fit {
  RefineStart start;
  SwitchingRegression model;         ///< start of expectation-maximisation, or a model with a logit
  LogitPrior logit_prior = {};       ///< prior of the logit's weights
  std::size_t row = 0;               ///< row of the start in the table
  Eigen::Index iterations = 0;       ///< number of iterations of expectation-maximisation that scores best on left-out
                                     ///< runs
  LeftOutScores scores = {};         ///< scores on the left-out runs
  std::vector<Bank> of_splits = {};  ///< the fit without the left-out runs of each split; empty if no run is left out

  // The fields below are set after expectation-maximisation on all training runs:
  Bank bank = {};
  SwitchingPrior prior = {};
  bool R_estimated = false;
};

}  // namespace modebank
