#pragma once

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

  enum class Got { line, overlong, waiting, end };
  /// Returns one of:
  /// - `line`: the next line, valid until the next call;
  /// - `waiting`: all input so far has been read, and the next call waits;
  /// - `overlong`: a line that is longer than any sample, without its text.
  Got next(std::string_view& line);
  /// Whether the last line lacks its newline, so that part of this line may be missing.
  bool is_unended() const { return unended_ && start_ >= buffer_.size(); }
  /// Whether a signal ended the input inside a line. Such a line is ignored.
  bool was_cut() const { return cut_; }

 private:
  std::string buffer_;
  std::size_t start_ = 0;
  bool waited_ = true, ended_ = false, discarding_ = false, unended_ = false, cut_ = false;

  /// Reads more input; false at its end.
  bool fill();
};

/// Writes all of `text` to standard output. Returns false if the reader of standard output has closed it. Throws
/// DataError for other failures.
bool write_out(std::string_view text);

}  // namespace modebank::app
