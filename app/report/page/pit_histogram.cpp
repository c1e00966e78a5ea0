#include "app/report/page/pit_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/base/distributions.hpp"

namespace modebank {

namespace {

void add(const Eigen::MatrixXd& transforms, PitHistogram& histogram) {
  const auto bins = static_cast<double>(histogram.counts.size());
  for (const double pit : transforms.reshaped()) {
    if (std::isnan(pit)) continue;
    ++histogram.counts(static_cast<Eigen::Index>(std::clamp(pit * bins, 0.0, bins - 1.0)));
    ++histogram.samples;
  }
}

}  // namespace

PitHistogram pit_histogram(const FilterEvaluation& evaluation, const std::vector<std::size_t>& runs,
                           Eigen::Index bins) {
  if (bins < 2) throw std::invalid_argument("a histogram has at least two bins");
  PitHistogram histogram;
  histogram.counts = Eigen::VectorXi::Zero(bins);
  for (const std::size_t i : runs)
    evaluation.with_run(i, {"pit"}, [&](const RunEvaluation& said) { add(said.pit, histogram); });
  if (histogram.samples == 0) return histogram;
  constexpr double outer_probability = 0.025;
  const double samples = static_cast<double>(histogram.samples), share = 1.0 / static_cast<double>(bins);
  histogram.expected = samples * share;
  histogram.band = {binomial_quantile(outer_probability, samples, share),
                    binomial_upper_quantile(outer_probability, samples, share)};
  return histogram;
}

}  // namespace modebank
