#include "io/recording/mcap_records.hpp"

#include <fmt/format.h>

namespace modebank::mcap {

namespace {

/// A copy of a record's content, because reading on invalidates the content.
std::string content_of(ByteSource& bytes, const Record& record) {
  constexpr std::uint64_t most_bytes = 16 * most_definition_bytes;
  if (record.content_bytes > most_bytes)
    throw Damage(record.at, fmt::format("a record of {} bytes is larger than {}", record.content_bytes, most_bytes));
  return std::string(bytes.view(record.content_at, record.content_bytes));
}

Compression compression_of(std::string_view name, std::uint64_t at) {
  if (name.empty()) return Compression::none;
  if (name == "lz4") return Compression::lz4;
  if (name == "zstd") return Compression::zstd;
  throw Damage(at, fmt::format("the compression \"{}\" is not supported (only none, lz4 and zstd)", name));
}

}  // namespace

Record read_record(ByteSource& bytes, std::uint64_t at, std::uint64_t end) {
  constexpr std::uint64_t front_bytes = 9;
  if (end - at < front_bytes) throw Damage(at, "it ends within a record");
  const std::string_view front = bytes.view(at, front_bytes);
  Record record;
  record.at = at;
  record.op = static_cast<Op>(front[0]);
  record.content_at = at + front_bytes;
  record.content_bytes = little_endian<std::uint64_t>(front.substr(1));
  if (record.content_bytes > end - record.content_at) throw Damage(at, "it ends within a record");
  return record;
}

RecordHead read_head(ByteSource& bytes, std::uint64_t at, std::uint64_t end) {
  const Record record = read_record(bytes, at, end);
  RecordHead head;
  head.at = at;
  head.end = record.end();
  head.payload_at = record.content_at;
  head.payload_bytes = record.content_bytes;
  if (record.op == Op::channel) {
    constexpr std::uint64_t number_bytes = 2;
    if (record.content_bytes < number_bytes) throw Damage(at, "a channel record is too short");
    head.kind = RecordHead::Kind::connection;
    head.connection = little_endian<std::uint16_t>(bytes.view(record.content_at, number_bytes));
  }
  if (record.op == Op::schema) head.kind = RecordHead::Kind::definition;
  if (record.op != Op::message) return head;
  constexpr std::uint64_t front_bytes = 22;  // channel, sequence, log time, publish time
  if (record.content_bytes < front_bytes) throw Damage(at, "a message record is too short");
  const std::string_view front = bytes.view(record.content_at, front_bytes);
  head.kind = RecordHead::Kind::message;
  head.connection = little_endian<std::uint16_t>(front);
  head.receive_ns = static_cast<std::int64_t>(little_endian<std::uint64_t>(front.substr(6)));
  head.payload_at += front_bytes;
  head.payload_bytes -= front_bytes;
  return head;
}

namespace {

/// The fields of a chunk that come before its content. `packed_bytes`: the declared length of the content.
Piece chunk_front(ByteSource& bytes, std::uint64_t at, std::uint64_t end, std::uint64_t& packed_bytes) {
  constexpr std::uint64_t longest_front = 64;  // times, size, checksum, compression, length
  FieldReader fields(bytes.view(at, std::min(end - at, longest_front)), at);
  fields.take(16);
  Piece piece;
  piece.unpacked_bytes = fields.number<std::uint64_t>();
  piece.crc = fields.number<std::uint32_t>();
  const std::string_view name = fields.text();
  piece.compression = compression_of(name, at);
  packed_bytes = fields.number<std::uint64_t>();
  piece.begin = at + 16 + 8 + 4 + 4 + name.size() + 8;
  piece.end = end;
  const std::uint64_t largest = std::max(piece.unpacked_bytes, packed_bytes);
  if (piece.compression != Compression::none && largest > most_chunk_bytes)
    throw Damage(at, fmt::format("a chunk of {} bytes is larger than {}", largest, most_chunk_bytes));
  return piece;
}

}  // namespace

Piece read_chunk(ByteSource& bytes, const Record& record) {
  std::uint64_t packed_bytes = 0;
  Piece piece = chunk_front(bytes, record.content_at, record.end(), packed_bytes);
  if (packed_bytes != piece.end - piece.begin) throw Damage(record.at, "a chunk's lengths do not agree");
  return piece;
}

Piece read_cut_chunk(ByteSource& bytes, std::uint64_t content_at) {
  std::uint64_t unused = 0;
  return chunk_front(bytes, content_at, bytes.size(), unused);
}

std::pair<std::uint16_t, Schema> read_schema(ByteSource& bytes, const Record& record) {
  const std::string content = content_of(bytes, record);
  FieldReader fields(content, record.content_at);
  const auto number = fields.number<std::uint16_t>();
  Schema schema;
  schema.name = fields.text();
  schema.encoding = fields.text();
  const std::string_view text = fields.text();
  if (text.size() > most_definition_bytes)
    throw Damage(record.at,
                 fmt::format("a definition of {} bytes is larger than {}", text.size(), most_definition_bytes));
  schema.text = text;
  return {number, std::move(schema)};
}

Channel read_channel(ByteSource& bytes, const Record& record) {
  const std::string content = content_of(bytes, record);
  FieldReader fields(content, record.content_at);
  Channel channel;
  channel.number = fields.number<std::uint16_t>();
  channel.schema = fields.number<std::uint16_t>();
  channel.topic = fields.text();
  channel.encoding = fields.text();
  return channel;
}

ChunkIndex read_chunk_index(ByteSource& bytes, const Record& record) {
  const std::string content = content_of(bytes, record);
  FieldReader fields(content, record.content_at);
  fields.take(16);
  ChunkIndex index;
  index.chunk_at = fields.number<std::uint64_t>();
  index.chunk_bytes = fields.number<std::uint64_t>();
  FieldReader offsets(fields.text(), record.content_at);
  while (!offsets.done()) {
    const auto channel = offsets.number<std::uint16_t>();
    index.message_indexes[channel] = offsets.number<std::uint64_t>();
  }
  return index;
}

std::uint64_t read_message_count(ByteSource& bytes, const Record& record) {
  return FieldReader(content_of(bytes, record), record.content_at).number<std::uint64_t>();
}

}  // namespace modebank::mcap
