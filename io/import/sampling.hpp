#pragma once

#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// How the streams of a data set become samples.
struct LogSampling {
  double rate_hz = 0.0;  ///< 0: the inputs' own times
  /// How the log's steps scatter (step_scatter in ident/data/streams.hpp), unless many of them make one new step. 0: no
  /// more than a model of one step length bears.
  double step_scatter = 0.0;
  AveragedColumns averaged = {};  ///< none at a rate near the log's or above
};

/// As data.rate_hz states; without it the inputs' own times are taken, however they scatter. One linear motion showed
/// modes at an even rate, too: interpolated or averaged over two steps where steps scatter by 15 %, averaged over four
/// where they scatter by 43 %. `runs`: in order of time. `learned`: which columns were averaged in the data that a bank
/// was learned from; null: these data decide. What the user should know is added to `notes`.
LogSampling choose_sampling(const std::vector<RunStreams>& runs, const DataOptions& options,
                            const AveragedColumns* learned, std::vector<std::string>& notes);

}  // namespace modebank
