#include "io/recording/payload.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "ident/base/utf8.hpp"
#include "io/recording/connections.hpp"

namespace modebank {

namespace {

template <class Integer>
void set_integer(Value& value, Integer number) {
  value.form = Value::Form::integer;
  value.exact = static_cast<std::int64_t>(number);  // NOLINT(bugprone-signed-char-misuse): an int8 is a number here
  value.number = static_cast<double>(number);
}

}  // namespace

PayloadReader::PayloadReader(std::string_view payload, Dialect dialect, unsigned wide_bytes)
    : bytes_(payload), cdr_(dialect == Dialect::ros2), wide_bytes_(wide_bytes) {
  if (!cdr_) return;
  if (bytes_.size() < 4) throw PayloadError("it has no encapsulation header");
  const unsigned encapsulation = static_cast<unsigned char>(bytes_[0]) * 256u + static_cast<unsigned char>(bytes_[1]);
  if (encapsulation > 1)
    throw PayloadError(fmt::format("its encapsulation 0x{:04x} is not plain CDR (0x0000 or 0x0001)", encapsulation));
  big_endian_ = encapsulation == 0;
  bytes_.remove_prefix(4);
}

void PayloadReader::need(std::uint64_t bytes) const {
  if (bytes > bytes_.size() - at_)
    throw PayloadError(fmt::format("it ends at byte {}, but needs {} more at byte {}", bytes_.size(), bytes, at_));
}

void PayloadReader::align(std::uint64_t bytes) {
  if (!cdr_ || bytes <= 1) return;
  const std::uint64_t over = at_ % bytes;
  if (over == 0) return;
  need(bytes - over);
  at_ += static_cast<std::size_t>(bytes - over);
}

std::uint64_t PayloadReader::bits(unsigned bytes) {
  align(bytes);
  need(bytes);
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bytes; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes_[at_ + (big_endian_ ? i : bytes - 1 - i)]);
  at_ += bytes;
  return value;
}

void PayloadReader::read(Kind kind, Value& value) {
  switch (kind) {
    case Kind::boolean:
      return set_integer(value, bits(1) != 0 ? 1 : 0);
    case Kind::int8:
      return set_integer(value, static_cast<std::int8_t>(bits(1)));
    case Kind::uint8:
      return set_integer(value, bits(1));
    case Kind::int16:
      return set_integer(value, static_cast<std::int16_t>(bits(2)));
    case Kind::uint16:
      return set_integer(value, bits(2));
    case Kind::int32:
      return set_integer(value, static_cast<std::int32_t>(bits(4)));
    case Kind::uint32:
      return set_integer(value, bits(4));
    case Kind::int64:
      return set_integer(value, static_cast<std::int64_t>(bits(8)));
    case Kind::uint64:
      set_integer(value, bits(8));
      value.form = Value::Form::natural;
      return;
    case Kind::float32:
      value.form = Value::Form::real;
      value.number = std::bit_cast<float>(static_cast<std::uint32_t>(bits(4)));
      return;
    case Kind::float64:
      value.form = Value::Form::real;
      value.number = std::bit_cast<double>(bits(8));
      return;
    case Kind::time:
    case Kind::duration: {
      // In ROS 1, a time has unsigned seconds and unsigned nanoseconds. A duration has signed seconds and signed
      // nanoseconds.
      const auto seconds = static_cast<std::uint32_t>(bits(4)), nanoseconds = static_cast<std::uint32_t>(bits(4));
      const bool natural = !cdr_ && kind == Kind::time;
      const std::int64_t whole = natural ? std::int64_t{seconds} : static_cast<std::int32_t>(seconds);
      const bool minus = !cdr_ && kind == Kind::duration;
      const std::int64_t part = minus ? static_cast<std::int32_t>(nanoseconds) : std::int64_t{nanoseconds};
      value.form = Value::Form::time;
      value.exact = whole * 1'000'000'000 + part;
      value.number = static_cast<double>(whole) + static_cast<double>(part) / 1e9;
      return;
    }
    case Kind::string:
      return read_text(value);
    case Kind::wstring:
      return read_wide_text(value);
    case Kind::message:
      break;
  }
}

void PayloadReader::read_text(Value& value) {
  const std::uint64_t length = bits(4);
  need(length);
  std::string_view text = bytes_.substr(at_, static_cast<std::size_t>(length));
  at_ += text.size();
  if (cdr_ && !text.empty()) {
    if (text.back() != '\0') throw PayloadError(fmt::format("the string before byte {} has no end", at_));
    text.remove_suffix(1);
  }
  value.form = Value::Form::text;
  value.text = text;
}

void PayloadReader::read_wide_text(Value& value) {
  const std::uint64_t length = bits(4);
  if (length > (bytes_.size() - at_) / wide_bytes_) need(length * wide_bytes_);
  value.form = Value::Form::text;
  value.text.clear();
  for (std::uint64_t i = 0; i < length; ++i) {
    auto c = static_cast<std::uint32_t>(bits(wide_bytes_));
    if (c >= 0xd800 && c < 0xdc00 && i + 1 < length) {
      c = 0x10000 + ((c & 0x3ff) << 10 | (static_cast<std::uint32_t>(bits(wide_bytes_)) & 0x3ff));
      ++i;
    }
    append_utf8(value.text, c);
  }
}

void PayloadReader::skip(Kind kind, std::uint64_t count) {
  const std::uint64_t bytes = kind == Kind::time || kind == Kind::duration ? 4 : bytes_of(kind);
  if (bytes > 0) {
    if (count == 0) return;
    align(bytes);
    if (count > (bytes_.size() - at_) / bytes_of(kind))
      need(std::min<std::uint64_t>(count, most_message_bytes) * bytes_of(kind));
    at_ += static_cast<std::size_t>(count * bytes_of(kind));
    return;
  }
  const unsigned each = kind == Kind::wstring ? wide_bytes_ : 1;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t length = bits(4);
    need(length * each);
    at_ += static_cast<std::size_t>(length * each);
  }
}

std::uint64_t PayloadReader::sequence_length(std::uint64_t least_bytes) {
  const std::uint64_t length = bits(4);
  check_room(least_bytes, length);
  return length;
}

void PayloadReader::check_room(std::uint64_t least_bytes, std::uint64_t count) const {
  if (least_bytes > 0 && count > (bytes_.size() - at_) / least_bytes)
    throw PayloadError(fmt::format("an array of {} elements at byte {} is longer than the message", count, at_));
}

void PayloadReader::empty_type() {
  if (cdr_) bits(1);
}

bool PayloadReader::consumed() const {
  // The end of a CDR message may be padded to a whole word.
  const std::size_t left = bytes_.size() - at_;
  return left == 0 || (cdr_ && left < 4 && bytes_.size() % 4 == 0);
}

}  // namespace modebank
