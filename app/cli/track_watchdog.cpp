#include "app/cli/track_watchdog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace modebank::app {

void Watchdog::took(double stamp_s, const Eigen::VectorXd& mode_probability) {
  ++samples_;
  ++all_samples_;
  stamp_s_ = stamp_s;
  mode_probability_ = mode_probability;
}

void Watchdog::answered(double latency_s) { slowest_s_ = std::max(slowest_s_, latency_s); }

double Watchdog::remaining_s(double now_s) const {
  return on() ? std::max(0.0, told_s_ + period_s_ - now_s) : std::numeric_limits<double>::infinity();
}

std::string Watchdog::what_came(double for_s) const {
  if (lines_ == 0) return fmt::format("no input for {:.3g} s", for_s);
  if (samples_ == 0) return fmt::format("no sample in the {} lines of {:.3g} s", lines_, for_s);
  constexpr double ms_per_s = 1e3;
  return fmt::format("{} samples in {:.3g} s, the slowest answered after {:.3g} ms", samples_, for_s,
                     ms_per_s * slowest_s_);
}

std::string Watchdog::due(double now_s) {
  if (!on() || now_s < told_s_ + period_s_) return {};
  std::string text = what_came(now_s - told_s_);
  if (all_samples_ > 0) {
    text += fmt::format("; {} samples in all, the last at {} s; mode probabilities", all_samples_, stamp_s_);
    for (const double probability : mode_probability_) text += fmt::format(" {:.3f}", probability);
  }
  told_s_ = now_s;
  lines_ = samples_ = 0;
  slowest_s_ = 0.0;
  return text;
}

}  // namespace modebank::app
