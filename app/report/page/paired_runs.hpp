#pragma once

#include <Eigen/Core>
#include <string>

#include "filter/judge/score/paired_gain.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// What the bank of one archive gains over another's on the same samples.
struct ArchiveGain {
  PairedGain gain;         ///< of `better` over `other`; NaN where nothing is in common
  Index runs = 0;          ///< judged runs that both hold with the same samples
  std::string difference;  ///< why there are none, in words
};

/// Over the judged runs of the same name, times and measurements: only there do densities compare.
ArchiveGain gain_between(const Archive& better, const Archive& other);

/// K x L: of mode a of `first` and mode b of `second`, the sum over samples of the smaller of their two probabilities,
/// each after its measurement, over that of the larger: 1 where both are as probable at every sample. Empty where no
/// judged run is in both.
Eigen::MatrixXd time_in_common(const Archive& first, const Archive& second);

/// " by 0.134 +- 0.040 nats per sample", without the error where it is not known.
std::string gain_words(const PairedGain& gain);

}  // namespace modebank::app::report
