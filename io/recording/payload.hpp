#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "io/recording/definition.hpp"

namespace modebank {

/// Thrown if a message does not fit its definition.
struct PayloadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One value of a message. It may be missing.
struct Value {
  enum class Form : std::uint8_t {
    missing,
    real,     ///< a number
    integer,  ///< a number, also stored as an exact integer
    natural,  ///< a number, also stored as an exact unsigned integer
    time,     ///< a number in seconds, also stored exactly in nanoseconds
    text
  };
  Form form = Form::missing;
  double number = 0.0;
  std::int64_t exact = 0;
  std::string text;
};

/// Reads a message in the order of its definition. In ROS 1, values are little-endian and contiguous. ROS 2 uses CDR
/// (XCDR1): each value is at a multiple of its size, and strings end with a zero byte.
class PayloadReader {
 public:
  /// `wide_bytes`: size of a character of a wstring. It is 4 in eProsima's CDR up to ROS 2 Humble, otherwise 2.
  PayloadReader(std::string_view payload, Dialect dialect, unsigned wide_bytes);

  void read(Kind kind, Value& value);
  void skip(Kind kind, std::uint64_t count);
  /// The length of a sequence. Each element has at least `least_bytes` bytes.
  std::uint64_t sequence_length(std::uint64_t least_bytes);
  /// Throws if the message is too short for `count` elements of at least `least_bytes` bytes.
  void check_room(std::uint64_t least_bytes, std::uint64_t count) const;
  /// Reads the single byte that stands for a type without fields.
  void empty_type();

  /// Whether nothing but the padding of the last word remains.
  bool consumed() const;
  std::size_t at() const { return at_; }

 private:
  void align(std::uint64_t bytes);
  void need(std::uint64_t bytes) const;
  std::uint64_t bits(unsigned bytes);
  void read_text(Value& value);
  void read_wide_text(Value& value);

  std::string_view bytes_;
  bool cdr_ = false, big_endian_ = false;
  unsigned wide_bytes_ = 4;
  std::size_t at_ = 0;
};

}  // namespace modebank
