#include "app/report/page/prediction_band.hpp"

#include <cmath>
#include <stdexcept>

#include "ident/base/distributions.hpp"

namespace modebank {

PredictionBand prediction_band(const Bank& bank, const RunEvaluation& evaluation, double level) {
  const Eigen::Index n_y = bank.C.rows(), N = evaluation.prediction.cols();
  if (!(level > 0.0 && level < 1.0)) throw std::invalid_argument("the level of a band lies between 0 and 1");
  if (bank.structure.states != evaluation.prediction.rows() || evaluation.innovation_covariance.rows() != n_y * n_y ||
      evaluation.innovation_covariance.cols() != N)
    throw std::invalid_argument("the evaluation is not one of this bank");
  const double quantile = std::sqrt(chi_square_quantile(level, 1.0));
  PredictionBand band{bank.C.leftCols(bank.structure.states) * evaluation.prediction, Eigen::MatrixXd(n_y, N)};
  for (Eigen::Index i = 0; i < n_y; ++i)
    band.half_width.row(i) = quantile * evaluation.innovation_covariance.row(i * (n_y + 1)).cwiseSqrt();
  return band;
}

std::vector<Eigen::Index> outlying_samples(const RunEvaluation& evaluation, double level) {
  const double edge = 0.5 * (1.0 - level);
  std::vector<Eigen::Index> samples;
  for (Eigen::Index k = 0; k < evaluation.pit.cols(); ++k) {
    const auto pit = evaluation.pit.col(k).array();
    if ((pit < edge || pit > 1.0 - edge).any()) samples.push_back(k);
  }
  return samples;
}

}  // namespace modebank
