#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Where a filter expected each measurement of a run: center +- half_width holds it with `level`, by the first two
/// moments of the predicted mixture. NaN where the filter predicted nothing.
struct PredictionBand {
  Eigen::MatrixXd center;      ///< n_y x N [state unit]
  Eigen::MatrixXd half_width;  ///< n_y x N [state unit]
};

/// Throws std::invalid_argument when sizes disagree or level is not inside (0, 1).
PredictionBand prediction_band(const Bank& bank, const RunEvaluation& evaluation, double level);

/// Samples of which some signal lies further out than a share `level` of a true filter's measurements would, by the
/// probability transform: those outliers are not judged by a Gaussian.
std::vector<Eigen::Index> outlying_samples(const RunEvaluation& evaluation, double level);

}  // namespace modebank
