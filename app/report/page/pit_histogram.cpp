#include "app/report/page/pit_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/base/distributions.hpp"

namespace modebank {

PitHistogram pit_histogram(const std::vector<const RunEvaluation*>& evaluations, Eigen::Index bins) {
  if (bins < 2) throw std::invalid_argument("a histogram has at least two bins");
  PitHistogram histogram;
  histogram.counts = Eigen::VectorXi::Zero(bins);
  for (const RunEvaluation* evaluation : evaluations)
    for (const double pit : evaluation->pit.reshaped()) {
      if (std::isnan(pit)) continue;
      const double bin = std::clamp(pit * static_cast<double>(bins), 0.0, static_cast<double>(bins - 1));
      ++histogram.counts(static_cast<Eigen::Index>(bin));
      ++histogram.samples;
    }
  if (histogram.samples == 0) return histogram;
  constexpr double outer_probability = 0.025;
  const double samples = static_cast<double>(histogram.samples), share = 1.0 / static_cast<double>(bins);
  histogram.expected = samples * share;
  histogram.band = {binomial_quantile(outer_probability, samples, share),
                    binomial_upper_quantile(outer_probability, samples, share)};
  return histogram;
}

}  // namespace modebank
