#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/score/paired_gain.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Gain of one archive's bank over another's on the same samples.
struct ArchiveGain {
  PairedGain gain;         ///< of `better` over `other`; NaN without common runs
  Index runs = 0;          ///< number of judged runs with equal samples in both
  std::string difference;  ///< reason why there are none
};

/// The gain over judged runs with equal names, times and measurements, since only their densities are comparable.
ArchiveGain gain_between(const Archive& better, const Archive& other);

/// K x L: of mode a of `first` and mode b of `second`, the sum over samples of the smaller of their two probabilities,
/// each after its measurement, over that of the larger: 1 where both are as probable at every sample. Empty where no
/// judged run is in both. `first_groups`, `second_groups`: to which group each mode belongs (family_of_modes); then the
/// same of the groups, whose probabilities are the sums of their modes'.
Eigen::MatrixXd time_in_common(const Archive& first, const Archive& second, const std::vector<Index>& first_groups = {},
                               const std::vector<Index>& second_groups = {});

/// " by 0.134 +- 0.040 nats per sample"; without the error if it is unknown.
std::string gain_words(const PairedGain& gain);

}  // namespace modebank::app::report
