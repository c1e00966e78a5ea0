#pragma once

#include <string>
#include <string_view>

namespace modebank::app {

/// Lines from standard input as they come, until the input ends or SIGINT or SIGTERM asks to stop: those are held back
/// except while waiting, so none is lost between two lines. One object per program.
class LineStream {
 public:
  LineStream();
  ~LineStream();
  LineStream(const LineStream&) = delete;
  LineStream& operator=(const LineStream&) = delete;

  enum class Got { line, overlong, waiting, end };
  /// `line`: the next one, valid until the next call. `waiting`: all that has arrived is read; the next call waits.
  /// `overlong`: a line that no sample is so long as, without its text. The last line may lack its newline.
  Got next(std::string_view& line);

 private:
  std::string buffer_;
  std::size_t start_ = 0;
  bool waited_ = true, ended_ = false, discarding_ = false;

  bool fill();
};

/// Writes all of `text` to standard output; false when nobody reads it any more. Throws DataError for other failures.
bool write_out(std::string_view text);

}  // namespace modebank::app
