#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"

namespace modebank {

/// Where each measurement was expected, in its unit, n_y x N; NaN where nothing was predicted.
struct PredictionBand {
  Eigen::MatrixXd centre, lower, upper;
};

/// C x[k|k-1] +- z sqrt(diag S), z the normal quantile that leaves the share `level` inside; S is the combined
/// prediction's, of a mixture its first two moments.
PredictionBand prediction_band(const Bank& bank, const RunEvaluation& evaluation, double level);

}  // namespace modebank
