// Checkpoints of a live filter.
#include <cmath>

#include "app/cli/tracker.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

void Tracker::go_on() {
  const Resumed resumed = resume(filter_, config_.track.resume, identity_);
  if (std::isnan(resumed.time_s)) return;
  resumed_s_ = stepped_s_ = resumed.time_s;
  validity_.go_on(resumed.samples, resumed.time_s);
  last_s_ = resumed.time_s - alignment_.reach_s();
  reader_.remember(resumed.input);
  samples_.go_on_after(resumed.time_s);
  messages_.say(fmt::format(
      "goes on after the sample at {} s ({}); send the samples after {}, and drop the lines of later "
      "samples: these are estimated again",
      resumed.time_s, config_.track.resume, *last_s_ < resumed.time_s ? fmt::format("{} s", *last_s_) : "it"));
}

void Tracker::save() const { app::save(filter_, config_.track.checkpoint, identity_); }

/// Saves a checkpoint while the filter runs. Before this, it writes the estimates up to this checkpoint, so that a
/// program that continues loses none. If the checkpoint cannot be written, the filter continues and tries again at the
/// next checkpoint.
void Tracker::keep() {
  checkpoint_due_ = false;
  try {
    save();
    if (checkpoint_fails_) messages_.say(fmt::format("{} is written again", config_.track.checkpoint));
    checkpoint_fails_ = false;
  } catch (const DataError& error) {
    if (!checkpoint_fails_)
      messages_.say(fmt::format("{}: the filter continues without it, and tries again every {} samples", error.what(),
                                config_.track.checkpoint_interval));
    checkpoint_fails_ = true;
  }
}

}  // namespace modebank::app
