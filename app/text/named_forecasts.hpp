#pragma once

#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The filter to predict with so many steps ahead, and what it is worth on the judged runs.
struct NamedForecast {
  Index steps = 1;
  std::string filter;
  std::string other;             ///< what it is compared with: the bank, or of the bank the best of the others
  double gain = not_a_number;    ///< of log score over that one [nats/sample]
  double error = not_a_number;   ///< standard error over runs; NaN of fewer than two
  std::string c_filter;          ///< the best that can be exported to C; empty where it is the filter itself
  double c_loss = not_a_number;  ///< what that one loses against the filter [nats/sample]
  std::string point_filter;      ///< of least error, where the filter's is over 2 % larger; else the filter
  double point_gain = 0.0;       ///< share of the filter's error that this one saved on training runs
};

/// One per horizon that was scored, 1 first. Training runs alone choose: as filters predict them that were learned
/// without them (/bank/left_out), or where nothing was left out as they are. The combination is named where its log
/// score gains 0.002 nats over every single filter's; else, of single filters that lose less than 0.02 nats to the
/// best, the one of least root mean square error. Where an error counts and its uncertainty does not, `point_filter`
/// may be another. Empty where nothing was scored.
std::vector<NamedForecast> named_forecasts(const Archive& archive);

/// "to understand: the bank of 3 modes; to predict: `--track.filter combined`, +0.041 +- 0.012 nats per sample over
/// bank, ...": what the finding and the names come to. Horizons of the same name stand together.
std::string use_words(const Archive& archive);

}  // namespace modebank::app
