#pragma once

#include <chrono>
#include <limits>
#include <string>
#include <string_view>

namespace modebank::app {

/// Lines from standard input as they come, until the input ends or SIGINT or SIGTERM arrives. Signals are blocked
/// except while waiting, so none is lost between two lines. One object per program.
class LineStream {
 public:
  LineStream();
  ~LineStream();
  LineStream(const LineStream&) = delete;
  LineStream& operator=(const LineStream&) = delete;

  using Clock = std::chrono::steady_clock;
  /// Seconds of that clock.
  static double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

  enum class Got { line, overlong, waiting, quiet, end };
  /// `line`: the next one, valid until the next call. `waiting`: all that has arrived is read; the next call waits.
  /// `overlong`: a line that no sample is so long as, without its text. `quiet`: nothing came for `wait_s`.
  Got next(std::string_view& line, double wait_s = std::numeric_limits<double>::infinity());
  /// Whether the input ended within the line that was read last: it lacks its newline, and may lack more.
  bool is_unended() const { return unended_ && start_ >= buffer_.size(); }
  /// Whether a signal ended the input within a line. That line is left out.
  bool was_cut() const { return cut_; }
  /// When what was read last had come.
  Clock::time_point arrival() const { return arrival_; }

 private:
  std::string buffer_;
  std::size_t start_ = 0;
  bool waited_ = true, ended_ = false, discarding_ = false, unended_ = false, cut_ = false;
  Clock::time_point arrival_ = Clock::now();

  enum class Filled { some, quiet, end };
  Filled fill(double wait_s);
};

/// Writes all of `text` to standard output; false when nobody reads it any more. Throws DataError for other failures.
bool write_out(std::string_view text);

}  // namespace modebank::app
