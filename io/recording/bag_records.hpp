#pragma once

#include <optional>
#include <string>

#include "io/recording/pieces.hpp"

namespace modebank::bag {

inline constexpr std::string_view magic = "#ROSBAG V2.0\n";

/// Type of a record; the record's field `op` contains it.
enum class Op : std::uint8_t {
  message = 0x02,
  header = 0x03,
  index = 0x04,
  chunk = 0x05,
  chunk_info = 0x06,
  connection = 0x07
};

/// A record: a header of named fields, followed by data.
struct Record {
  Op op{};
  std::string header;  ///< fields name=value, each preceded by its length in four bytes
  std::uint64_t at = 0, data_at = 0, data_bytes = 0;

  std::uint64_t end() const { return data_at + data_bytes; }
  /// Value of a field. Throws Damage if the field is missing.
  std::string_view field(std::string_view name) const;
  template <class T>
  T number(std::string_view name) const {
    const std::string_view value = field(name);
    if (value.size() != sizeof(T))
      throw Damage(at, "a record's field \"" + std::string(name) + "\" has the wrong size");
    return little_endian<T>(value);
  }
  /// A field with a time, in seconds and nanoseconds.
  std::int64_t time_ns(std::string_view name) const;
};

/// The record at position `at`. Throws Damage unless the record ends at or before `end`.
Record read_record(ByteSource& bytes, std::uint64_t at, std::uint64_t end);

/// The type and the positions of a record without its content, because readers skip millions of records.
RecordHead read_head(ByteSource& bytes, std::uint64_t at, std::uint64_t end);

/// The value of one of several named fields. Nullopt if the field is missing.
std::optional<std::string_view> find_field(std::string_view fields, std::string_view name, std::uint64_t at);

}  // namespace modebank::bag
