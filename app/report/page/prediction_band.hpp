#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Band of a filter's predictions in a run. It is computed from mean and variance of the predicted mixture. center +-
/// half_width contains a measurement with probability `level`. NaN without a prediction.
struct PredictionBand {
  Eigen::MatrixXd center;      ///< n_y x N [state unit]
  Eigen::MatrixXd half_width;  ///< n_y x N [state unit]
};

/// Throws std::invalid_argument if sizes do not fit or `level` is not between 0 and 1.
PredictionBand prediction_band(const Bank& bank, const RunEvaluation& evaluation, double level);

/// Samples with an outlying signal. If the model is right, only a fraction 1 - `level` of the measurements lies so far
/// out. Uses the probability integral transform of the mixture, not a Gaussian.
std::vector<Eigen::Index> outlying_samples(const RunEvaluation& evaluation, double level);

}  // namespace modebank
