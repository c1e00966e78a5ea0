#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/config.hpp"
#include "ident/data_advice.hpp"
#include "ident/lag_report.hpp"
#include "ident/run_check.hpp"

namespace modebank::app {

/// One run as recorded.
struct RunReport {
  std::string run;
  Role role = Role::train;
  SamplingCheck inputs, states;
  std::vector<ChannelCheck> input, state;                ///< per channel
  std::vector<double> input_saturated, state_saturated;  ///< per channel, share of samples
  CommandCheck commands;
  RestCheck rest;
  Index excitation = 0;
  RunLag lag;
  Index transitions = 0;  ///< joined, without gaps
  DeficientWindows windows;
  std::string problem;  ///< why it cannot be joined; empty: it can
};

/// A channel over all runs.
struct ChannelSummary {
  Channel channel;
  bool is_state = false;
  ChannelCheck values;
  SaturationLimits limits{0.0, 0.0, false};
  double saturated = 0.0;
};

struct DataCheck {
  Index window_length = 0;
  std::vector<RunReport> runs;
  std::vector<ChannelSummary> channels;  ///< states, then inputs
  LagReport lag;
  bool has_lag = false;
  RateFacts rate_facts;
  RateAdvice rate;
  LengthAdvice length;
  LossAdvice loss;
  std::vector<std::string> findings;  ///< in words
  std::string unusable;               ///< why nothing can be identified; empty: something can
};

/// Reads all runs leniently and gathers every number. Throws as read_streams does.
DataCheck check_data(const Config& config);

/// What stands out, each with what would accept or mend it.
std::vector<std::string> findings_of(const DataCheck& check, const Config& config);

std::string check_text(const DataCheck& check);
nlohmann::json check_json(const DataCheck& check);

/// Why the advice is what it is.
std::string rate_reason(const DataCheck& check);
std::string length_reason(const DataCheck& check);
std::string loss_reason(const DataCheck& check);

}  // namespace modebank::app
