#pragma once

#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/init/guess.hpp"
#include "io/archive/archive.hpp"

/// Doubts about what acts on the states, from fits of the linear stage (ident/lag/linear_stage.hpp) to the training
/// runs, at most 20,000 samples of them. Empty where the stage was not asked for a structure, or skipped.
namespace modebank::app {

/// - Inputs by whose value of the same sample the single linear model gains, although a delay of 0 was not let compete,
///   because they are not held: they act at once, or are computed from the state.
/// - An RMSE of the single linear model with a delay of 0 below the sensor noise of the best one of delay 1 or more.
std::vector<std::string> delay_doubts(const Archive& archive);

/// Channels that gain 6 nats for each state as one more input, by their gain: "collective_pct also moves altitude_m (41
/// nats): data.input = ...". `config`: that of the archive. `left`: channels that are neither states nor inputs; those
/// that may act are tried, the likeliest first, at a few delays.
std::vector<std::string> left_channel_doubts(const Archive& archive, const Config& config,
                                             std::vector<ChannelLeft> left);

}  // namespace modebank::app
