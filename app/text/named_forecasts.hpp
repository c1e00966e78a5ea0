#pragma once

#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The filter to use for predictions this many steps ahead, and its gain on the judged runs.
struct NamedForecast {
  Index steps = 1;
  std::string filter;
  std::string other;             ///< filter to compare with: the bank, or for the bank the best of the others
  double gain = not_a_number;    ///< gain of log score over `other` [nats/sample]
  double error = not_a_number;   ///< standard error over runs; NaN for fewer than two
  std::string c_filter;          ///< the best filter that can be exported to C; empty if that is the filter itself
  double c_loss = not_a_number;  ///< loss of that filter against the named one [nats/sample]
  std::string point_filter;      ///< the filter with the smallest error if the named filter's error is over 2 % larger;
                                 ///< else the named filter
  double point_gain = 0.0;       ///< share of the filter's error that point_filter saves on training runs
};

/// One entry per scored horizon, 1 first; empty without scores.
/// - Only training runs decide. Their predictions come from filters learned without them (/bank/left_out), or from the
///   filters themselves if nothing was left out.
/// - The combination is named if its log score gains 0.002 nats over every single filter.
/// - Otherwise the filters that lose less than 0.02 nats to the best are compared. The one with the smallest root mean
///   square error is named.
/// - `point_filter` is the best choice if only the error matters.
std::vector<NamedForecast> named_forecasts(const Archive& archive);

/// One sentence on the finding and the named filters: "to understand the motion: the 3 modes; to predict:
/// `--track.filter combined` (against `drifting` each sample is 4.2 % more likely, +0.041 +- 0.012 nats; ...)". Gains
/// are over the finding's best competitor. Horizons with the same named filter share an entry.
std::string use_words(const Archive& archive);

}  // namespace modebank::app
