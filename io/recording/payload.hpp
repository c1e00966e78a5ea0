#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "io/recording/definition.hpp"

namespace modebank {

/// A message that does not have the form its definition says.
struct PayloadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One value of a message, or none.
struct Value {
  enum class Form : std::uint8_t {
    missing,
    real,     ///< number
    integer,  ///< number and exact
    natural,  ///< the same, exact as an unsigned number
    time,     ///< number in seconds, exact in nanoseconds
    text
  };
  Form form = Form::missing;
  double number = 0.0;
  std::int64_t exact = 0;
  std::string text;
};

/// Goes through a message in the order of its definition. ROS 1 writes values side by side, little-endian; ROS 2 writes
/// CDR (XCDR1): every value stands at a multiple of its size, and strings end with a zero byte.
class PayloadReader {
 public:
  /// `wide_bytes`: of a character of a wstring, 4 as eProsima's CDR of ROS 2 up to Humble writes it, or 2.
  PayloadReader(std::string_view payload, Dialect dialect, unsigned wide_bytes);

  void read(Kind kind, Value& value);
  void skip(Kind kind, std::uint64_t count);
  /// The length of a sequence whose elements take at least this many bytes.
  std::uint64_t sequence_length(std::uint64_t least_bytes);
  /// Throws unless the message has room for so many elements of at least so many bytes.
  void check_room(std::uint64_t least_bytes, std::uint64_t count) const;
  /// The byte that stands for a type without fields.
  void empty_type();

  /// Whether nothing is left but what fills the last word.
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
