#pragma once

#include "io/recording/pieces.hpp"

namespace modebank::mcap {

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  data_end = 0x0f
};

/// A record: its type, its length in eight bytes, and its content.
struct Record {
  Op op{};
  std::uint64_t at = 0, content_at = 0, content_bytes = 0;
  std::uint64_t end() const { return content_at + content_bytes; }
};

/// The record at position `at`. Throws Damage unless the record ends at or before `end`.
Record read_record(ByteSource& bytes, std::uint64_t at, std::uint64_t end);

RecordHead read_head(ByteSource& bytes, std::uint64_t at, std::uint64_t end);

/// The content of a chunk, found from the fields at its beginning. Throws Damage for an unknown compression and for
/// impossible sizes.
Piece read_chunk(ByteSource& bytes, const Record& record);

/// The content of a chunk that is cut off by the end of the file.
Piece read_cut_chunk(ByteSource& bytes, std::uint64_t content_at);

struct Schema {
  std::string name, encoding, text;
};

struct Channel {
  std::uint16_t number = 0, schema = 0;
  std::string topic, encoding;
};

struct ChunkIndex {
  std::uint64_t chunk_at = 0, chunk_bytes = 0;
  std::map<std::uint16_t, std::uint64_t> message_indexes;  ///< position of each channel's index
};

/// A schema and its number.
std::pair<std::uint16_t, Schema> read_schema(ByteSource& bytes, const Record& record);
Channel read_channel(ByteSource& bytes, const Record& record);
ChunkIndex read_chunk_index(ByteSource& bytes, const Record& record);
/// Number of messages in the file, as its statistics record states.
std::uint64_t read_message_count(ByteSource& bytes, const Record& record);

}  // namespace modebank::mcap
