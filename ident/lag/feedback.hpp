#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Largest |t| of innovations in regressions of the inputs on their own lags.
struct InputFeedback {
  double past_t = 0.0;  ///< of the innovation one sample before: the inputs answer to the states
  double same_sample_t =
      0.0;  ///< of the same sample's: an answer within it, or an effect without delay; both look alike
};

/// Innovations are those of a least-squares model of three state lags and the inputs before them. Of the standard error
/// that constant noise gives and White's, which allows for noise that varies, the larger one counts. NaN without
/// inputs, or without twice as many samples as coefficients.
InputFeedback input_feedback(const Recording& recording);

}  // namespace modebank
