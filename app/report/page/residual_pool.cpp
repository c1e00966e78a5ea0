#include "app/report/page/residual_pool.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/not_a_number.hpp"

namespace modebank {

ResidualTests pool_autocorrelations(const std::vector<ResidualTests>& runs) {
  ResidualTests pooled;
  Index lags = 0;
  for (const ResidualTests& run : runs) {
    lags = std::max(lags, run.autocorrelation.cols());
    pooled.level = run.level;
  }
  const Index states = runs.empty() ? 0 : runs.front().states();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(states, lags), weight = sum;
  double band_weight = 0.0, band = 0.0;
  for (const ResidualTests& run : runs) {
    if (run.autocorrelation.array().isNaN().any()) continue;
    const auto samples = static_cast<double>(run.samples);
    sum.leftCols(run.autocorrelation.cols()) += samples * run.autocorrelation;
    weight.leftCols(run.autocorrelation.cols()).array() += samples;
    pooled.samples += run.samples;
    band_weight += samples;
    band = run.autocorrelation_band * std::sqrt(samples);  // multiplied by the root of the samples, the band is the
                                                           // normal quantile, which is the same for all runs
  }
  pooled.autocorrelation = (weight.array() > 0.0).select(sum.cwiseQuotient(weight), not_a_number);
  pooled.autocorrelation_band = band_weight > 0.0 ? band / std::sqrt(band_weight) : not_a_number;
  return pooled;
}

}  // namespace modebank
