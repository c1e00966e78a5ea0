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
  /// Scatter of the log's steps (step_scatter in ident/data/streams.hpp). 0 in two cases: the scatter is small enough
  /// for a model of one step length, or many steps of the log make one new step.
  double step_scatter = 0.0;
  AveragedColumns averaged = {};  ///< empty if the sampling rate is near the log's rate or above it
};

/// Chooses the sampling: data.rate_hz, or without it the inputs' own times, even if they scatter. An even rate would
/// not help. In experiments on one linear motion, the resampled motion still looked like several modes. Samples were
/// interpolated or averaged over two steps with a scatter of 15 %, or averaged over four steps with a scatter of 43 %.
/// - `runs`: in order of time.
/// - `learned`: the averaged columns of an existing bank's data; null: they are found in these data.
/// - `notes`: receives remarks for the user.
LogSampling choose_sampling(const std::vector<RunStreams>& runs, const DataOptions& options,
                            const AveragedColumns* learned, std::vector<std::string>& notes);

}  // namespace modebank
