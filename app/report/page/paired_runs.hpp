#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/score/paired_gain.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Gain of one archive's bank over another's on the same samples.
struct ArchiveGain {
  PairedGain gain;         ///< gain of `better` over `other`; NaN without common runs
  Index runs = 0;          ///< number of judged runs with equal samples in both
  std::string difference;  ///< reason why there are no common runs
};

/// The gain over judged runs with equal names, times and measurements: only their densities are comparable.
ArchiveGain gain_between(const Archive& better, const Archive& other);

/// Common time (K x L) of mode a of `first` and mode b of `second`. It is the sum over samples of the smaller of both
/// probabilities, divided by the sum of the larger ones. 1 means equal probabilities at every sample. The probabilities
/// are those after each sample's measurement. Empty if no judged run is in both archives.
/// `first_groups`, `second_groups`: the group of each mode (family_of_modes). With them the result is for groups, whose
/// probability is the sum over their modes.
Eigen::MatrixXd time_in_common(const Archive& first, const Archive& second, const std::vector<Index>& first_groups = {},
                               const std::vector<Index>& second_groups = {});

/// " by 0.134 +- 0.040 nats per sample"; without the error if it is unknown.
std::string gain_words(const PairedGain& gain);

}  // namespace modebank::app::report
