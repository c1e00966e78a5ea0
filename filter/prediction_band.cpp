#include "filter/prediction_band.hpp"

#include <cmath>
#include <stdexcept>

#include "filter/calibration.hpp"

namespace modebank {

PredictionBand prediction_band(const Bank& bank, const RunEvaluation& evaluation, double level) {
  if (!(level > 0.0 && level < 1.0)) throw std::invalid_argument("prediction_band: level must be in (0, 1)");
  const Eigen::Index measured = bank.C.rows();
  const double z = std::sqrt(chi_square_quantile(level, 1.0));
  PredictionBand band;
  band.centre = bank.C * evaluation.prediction;
  band.lower = band.centre;
  band.upper = band.centre;
  for (Eigen::Index i = 0; i < measured; ++i) {
    const Eigen::ArrayXd sd = evaluation.innovation_covariance.row(i * (measured + 1)).array().sqrt();
    band.lower.row(i).array() -= z * sd.transpose();
    band.upper.row(i).array() += z * sd.transpose();
  }
  return band;
}

}  // namespace modebank
