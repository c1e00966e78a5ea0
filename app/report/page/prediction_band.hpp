#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Band of a filter's predictions in a run. center +- half_width contains a measurement with probability `level`,
/// computed from mean and variance of the predicted mixture. NaN without a prediction.
struct PredictionBand {
  Eigen::MatrixXd center;      ///< n_y x N [state unit]
  Eigen::MatrixXd half_width;  ///< n_y x N [state unit]
};

/// Throws std::invalid_argument if sizes disagree or level is not inside (0, 1).
PredictionBand prediction_band(const Bank& bank, const RunEvaluation& evaluation, double level);

/// Samples with an outlying signal: if the model is right, a share `level` of the measurements lies further out. Uses
/// the probability integral transform of the mixture, not a Gaussian.
std::vector<Eigen::Index> outlying_samples(const RunEvaluation& evaluation, double level);

}  // namespace modebank
