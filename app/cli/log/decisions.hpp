#pragma once

#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/cli/log/log_configuration.hpp"
#include "io/archive/archive.hpp"

/// Decisions of `run LOG` where `check` and `next` advise, each with its figure.
namespace modebank::app {

/// How much is tried, counted in searches and not in seconds: the same log gives the same answer on every machine.
enum class Effort {
  quick,     ///< what `run` finds by default: lags, delay, and the lag between two instruments
  normal,    ///< also the lag of the inputs within one table and the measurement noise, judged by one linear motion
  thorough,  ///< also rate, windows' length, loss and restarts, all judged by banks learned as `run` learns them
};

/// By its name, which the table of commands has checked.
Effort effort_of(const std::string& word);

/// Tries settings on training runs that are left out, and puts those that gain into the configuration, the others into
/// a comment. Keys in `stated` are not decided. Returns a sentence for each decision.
std::vector<std::string> decide(const Config& config, Effort effort, const KeyValues& stated,
                                LogConfiguration& configuration, const Listener& listener);

/// Puts what `run` found into the reasons of the keys by which it was found: lag, structure, measurement noise.
void explain_found(const Archive& archive, LogConfiguration& configuration);

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::Effort> {
  static constexpr Names<3> values{"quick", "normal", "thorough"};
};
