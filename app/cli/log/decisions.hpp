#pragma once

#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/cli/log/log_configuration.hpp"
#include "io/archive/archive.hpp"

/// Decisions of `run LOG` on settings for which `check` and `next` only give advice. Each decision states its gain.
namespace modebank::app {

/// Amount of search. It is a number of trials, not of seconds, so that the same log gives the same result on every
/// machine.
enum class Effort {
  quick,     ///< the search of `run` by default: lags, delay, and the lag between two instruments
  normal,    ///< also the lag of inputs in the same table and the measurement noise, both judged with a bank of one
             ///< mode
  thorough,  ///< also rate, window length, loss and restarts, all judged with banks learned as in `run`
};

/// The effort with this name. The table of commands has already checked the name.
Effort effort_of(const std::string& word);

/// Tries settings on training runs left out. Writes settings that gain into the configuration, and the others into a
/// comment. Keys in `stated` are not changed. Returns one sentence for each decision.
std::vector<std::string> decide(const Config& config, Effort effort, const KeyValues& stated,
                                LogConfiguration& configuration, const Listener& listener);

/// Adds the results of `run` to the reasons of the keys that caused these results: lag, structure, measurement noise.
void explain_found(const Archive& archive, LogConfiguration& configuration);

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::Effort> {
  static constexpr Names<3> values{"quick", "normal", "thorough"};
};
