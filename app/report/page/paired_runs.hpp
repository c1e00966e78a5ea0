#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/score/paired_gain.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// Gain of one archive's bank over another archive's bank on the same samples.
struct ArchiveGain {
  PairedGain gain;         ///< gain of `better` over `other`; NaN if they have no runs in common
  Index runs = 0;          ///< number of judged runs with equal samples in both archives
  std::string difference;  ///< reason why the archives have no runs in common
};

/// The gain over judged runs with equal names, times and measurements. Densities of other runs are not comparable.
ArchiveGain gain_between(const Archive& better, const Archive& other);

/// Common time (K x L) of mode a of `first` and mode b of `second`. It is the sum of the smaller probability over all
/// samples, divided by the sum of the larger probability. The value 1 means equal probabilities at every sample. The
/// probabilities are those after each sample's measurement. Empty if the archives have no judged run in common.
Eigen::MatrixXd time_in_common(const Archive& first, const Archive& second);

/// Text such as " by 0.134 +- 0.040 nats per sample". It has no error if the error is unknown.
std::string gain_words(const PairedGain& gain);

}  // namespace modebank::app::report
