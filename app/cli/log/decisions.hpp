#pragma once

#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/cli/log/log_configuration.hpp"
#include "io/archive/archive.hpp"

/// Decisions of `run LOG` on settings for which `check` and `next` only advise. Each is stated with its gain.
namespace modebank::app {

/// Amount of search, in numbers of trials and not in seconds, so that the same log gives the same result on every
/// machine.
enum class Effort {
  quick,     ///< what `run` finds by default: lags, delay, and the lag between two instruments
  normal,    ///< also the lag of the inputs within one table and the measurement noise, judged by a bank of one mode
  thorough,  ///< also rate, window length, loss and restarts, all judged by banks learned as in `run`
};

/// The effort with this name. The table of commands has checked the name.
Effort effort_of(const std::string& word);

/// Tries settings on training runs left out. Settings that gain go into the configuration, the others into a comment.
/// Keys in `stated` are not changed. Returns one sentence for each decision.
std::vector<std::string> decide(const Config& config, Effort effort, const KeyValues& stated,
                                LogConfiguration& configuration, const Listener& listener);

/// Adds the results of `run` to the reasons of the keys that led to them: lag, structure, measurement noise.
void explain_found(const Archive& archive, LogConfiguration& configuration);

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::Effort> {
  static constexpr Names<3> values{"quick", "normal", "thorough"};
};
