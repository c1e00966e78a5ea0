#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

namespace modebank::app {

/// Says at a stated period how a live filter fares, whether samples come or not. Its clock is the caller's: seconds
/// from any moment, which only go forward.
class Watchdog {
 public:
  /// `period_s`: 0: never says anything.
  Watchdog(double period_s, double now_s) : period_s_(period_s), told_s_(now_s) {}

  bool on() const { return period_s_ > 0.0; }
  /// A line came in; a sample was taken, its stamp and the mode probabilities after it; its estimate left so long after
  /// it had arrived.
  void heard() { ++lines_; }
  void took(double stamp_s, const Eigen::VectorXd& mode_probability);
  void answered(double latency_s);
  /// Until the next line is due; infinite when it never is.
  double remaining_s(double now_s) const;
  /// The line that is due, without its time; empty when none is.
  std::string due(double now_s);

 private:
  double period_s_, told_s_;
  std::size_t lines_ = 0, samples_ = 0, all_samples_ = 0;  ///< since the last line was said, but for the last
  double stamp_s_ = 0.0, slowest_s_ = 0.0;
  Eigen::VectorXd mode_probability_;

  std::string what_came(double for_s) const;
};

}  // namespace modebank::app
