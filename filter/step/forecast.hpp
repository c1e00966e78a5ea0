#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// Seed for the draws of one run.
std::uint64_t pit_seed(std::uint64_t seed, std::string_view run);

/// Draws the transform of a quantised measurement within its interval (ImmFilter::transform). Moves `pit` (n_y) from
/// the middle of an interval of `width` (n_y) to a uniformly drawn point of the interval. If the model is correct, the
/// transform is then uniform. The draw depends only on `of_run` (pit_seed) and the sample's number. Continuous signals
/// (width 0) do not change.
void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit);

/// Verdict about a live sample, in addition to its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, predicted measurement
  Eigen::VectorXd lower, upper;  ///< n_y, predicted interval: +- quantile * sqrt(S_ii), by the moments of the mixture
  bool alarm = false;            ///< whether some signal lies in one of the two tails of probability 0.0005
};

/// Judges samples by the filter's own uncertainty. The alarm uses the probability transform, which has the same
/// distribution for every mixture; the NIS does not. A correct model with one signal has one alarm in 1000 samples.
class LiveJudge {
 public:
  explicit LiveJudge(const Bank& bank);
  /// Judges one sample; does not allocate.
  const LiveVerdict& judge(const FilterEstimate& estimate);

 private:
  Eigen::MatrixXd C_;
  double interval_quantile_;
  LiveVerdict verdict_;
};

}  // namespace modebank
