#pragma once

#include <string>

#include "filter/judge/finding.hpp"
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

/// Text such as " by 0.134 +- 0.040 nats per sample". It has no error if the error is unknown.
std::string gain_words(const PairedGain& gain);

}  // namespace modebank::app::report
