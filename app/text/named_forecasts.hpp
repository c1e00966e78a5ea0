#pragma once

#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The filter to use for predictions this many steps ahead, and its gain on the judged runs.
struct NamedForecast {
  Index steps = 1;
  std::string filter;
  std::string other;             ///< filter of the comparison: the bank, or for the bank the best of the others
  double gain = not_a_number;    ///< gain of log score over that one [nats/sample]
  double error = not_a_number;   ///< standard error over runs; NaN for fewer than two
  std::string c_filter;          ///< the best filter that can be exported to C; empty if that is the filter itself
  double c_loss = not_a_number;  ///< loss of that one against the filter [nats/sample]
  std::string point_filter;  ///< the filter with the smallest error if the filter's is over 2 % larger; else the filter
  double point_gain = 0.0;   ///< share of the filter's error that point_filter saves on training runs
};

/// One entry per scored horizon, 1 first. Training runs alone decide: by predictions of filters that were learned
/// without them (/bank/left_out), or, where nothing was left out, by the filters' own. The combination is named if its
/// log score gains 0.002 nats over every single filter. Otherwise it is the single filter with the smallest root mean
/// square error, among those that lose less than 0.02 nats to the best. `point_filter` is the choice where only the
/// error matters, not its uncertainty. Empty without scores.
std::vector<NamedForecast> named_forecasts(const Archive& archive);

/// "to understand the motion: the 3 modes; to predict: `--track.filter combined` (against `drifting` each
/// sample is 4.2 % more likely, +0.041 +- 0.012 nats; ...)": what the finding and the names come to, compared with the
/// finding's best competitor. Horizons of the same name stand together.
std::string use_words(const Archive& archive);

}  // namespace modebank::app
