#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

namespace modebank::app {

/// Makes the status line of a live filter at a fixed period, even if no samples arrive. The caller passes the time in
/// seconds. Its origin is arbitrary, and it must never decrease.
class Watchdog {
 public:
  /// `period_s`: 0 means no status lines.
  Watchdog(double period_s, double now_s) : period_s_(period_s), told_s_(now_s) {}

  bool on() const { return period_s_ > 0.0; }
  /// Events to report:
  /// - a line was read;
  /// - a sample was used, with its stamp and the mode probabilities after this sample;
  /// - an estimate was written, with the delay since the arrival of its sample.
  void line_arrived() { ++lines_; }
  void took(double stamp_s, const Eigen::VectorXd& mode_probability);
  void answered(double latency_s);
  /// Time until the next status line; infinite if there is none.
  double remaining_s(double now_s) const;
  /// The status line, if it is due; else empty. It does not contain a time.
  std::string due(double now_s);

 private:
  double period_s_, told_s_;
  std::size_t lines_ = 0, samples_ = 0,
              all_samples_ = 0;  ///< counts since the last status line, but all_samples_ counts since the start
  double stamp_s_ = 0.0, slowest_s_ = 0.0;
  Eigen::VectorXd mode_probability_;

  std::string what_came(double for_s) const;
};

}  // namespace modebank::app
