#pragma once

#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// How the streams of a data set are sampled.
struct LogSampling {
  double rate_hz = 0.0;  ///< 0: the inputs' own times
  /// Scatter of the log's steps (step_scatter in ident/data/streams.hpp). 0: small enough for a model of one step
  /// length, or many steps of the log make one new step.
  double step_scatter = 0.0;
  AveragedColumns averaged = {};  ///< empty if the rate is near the log's or above
};

/// Sampling by data.rate_hz; without data.rate_hz at the inputs' own times, even if they scatter. Experiments on one
/// linear motion show why an even rate does not help: the motion looked like several modes, too. This happened with
/// samples interpolated or averaged over two steps with a scatter of 15 %, and averaged over four steps with 43 %.
/// - `runs`: in order of time.
/// - `learned`: the averaged columns of an existing bank's data; null: found in these data.
/// - `notes`: receives remarks for the user.
LogSampling choose_sampling(const std::vector<RunStreams>& runs, const DataOptions& options,
                            const AveragedColumns* learned, std::vector<std::string>& notes);

}  // namespace modebank
