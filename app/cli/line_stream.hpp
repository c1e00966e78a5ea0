#pragma once

#include <chrono>
#include <limits>
#include <string>
#include <string_view>

namespace modebank::app {

/// Lines of standard input as they arrive, until the input ends or SIGINT or SIGTERM arrives. Signals are blocked
/// except while waiting, so none is lost between two lines. A program must have only one object of this class.
class LineStream {
 public:
  LineStream();
  ~LineStream();
  LineStream(const LineStream&) = delete;
  LineStream& operator=(const LineStream&) = delete;

  using Clock = std::chrono::steady_clock;
  /// Present time of this clock [s].
  static double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

  enum class Got { line, overlong, waiting, quiet, end };
  /// Returns one of:
  /// - `line`: the next line, valid until the next call;
  /// - `waiting`: all input so far has been read, and the next call waits;
  /// - `overlong`: a line that is longer than any sample, without its text;
  /// - `quiet`: no input arrived for `wait_s`.
  Got next(std::string_view& line, double wait_s = std::numeric_limits<double>::infinity());
  /// Whether the last line lacks its newline, so that part of this line may be missing.
  bool is_unended() const { return unended_ && start_ >= buffer_.size(); }
  /// Whether a signal ended the input inside a line. Such a line is ignored.
  bool was_cut() const { return cut_; }
  /// Arrival time of the last input.
  Clock::time_point arrival() const { return arrival_; }

 private:
  std::string buffer_;
  std::size_t start_ = 0;
  bool waited_ = true, ended_ = false, discarding_ = false, unended_ = false, cut_ = false;
  Clock::time_point arrival_ = Clock::now();

  enum class Filled { some, quiet, end };
  Filled fill(double wait_s);
};

/// Writes all of `text` to standard output. Returns false if the reader of standard output has closed it. Throws
/// DataError for other failures.
bool write_out(std::string_view text);

}  // namespace modebank::app
