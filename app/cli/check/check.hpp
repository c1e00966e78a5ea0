#pragma once

#include <string>
#include <vector>

#include "ident/check/run_check.hpp"
#include "ident/lag/report.hpp"
#include "io/import/options.hpp"

namespace modebank {

/// One recorded run.
struct RunReport {
  std::string run;
  Role role = Role::train;
  SamplingCheck inputs, states;
  std::vector<ChannelCheck> input, state;                ///< per channel
  std::vector<double> input_saturated, state_saturated;  ///< for each channel, the share of saturated samples
  CommandCheck commands;
  RestCheck rest;
  Index excitation = 0;
  RunLag lag;
  Index transitions = 0;  ///< transitions of the joined run; gaps do not count
  DeficientWindows windows;
  std::string problem;  ///< reason why the run cannot be joined; empty if it can
};

/// A channel over all runs.
struct ChannelSummary {
  Channel channel;
  bool is_state = false;
  ChannelCheck values;
  double repeated = 0.0;  ///< share of samples in motion with the same value as the sample before
  SaturationLimits limits{0.0, 0.0, false};
  double saturated = 0.0;
};

struct DataCheck {
  Index window_length = 0;
  std::vector<RunReport> runs;
  std::vector<ChannelSummary> channels;  ///< the states, then the inputs
  LagReport lag;
  bool has_lag = false;
  Index longest_stretch = 0;            ///< longest sequence of transitions without a gap in the training runs
  std::vector<std::string> dominating;  ///< remarks on values so large that they would dominate least squares
  std::string unidentifiable_effects;   ///< remark on effects that the training runs leave unidentifiable; empty if
                                        ///< there are none
  std::string unusable;                 ///< reason why no model can be identified; empty if one can
};

/// The data to check, and the length of the windows.
struct CheckOptions {
  DataOptions data;
  Index window_length = 0;  ///< transitions
  bool intercept = false;
};

/// Reads all runs, tolerates faults, and computes the report. Throws the exceptions of read_streams.
DataCheck check_data(const CheckOptions& options);

}  // namespace modebank
