#include "io/recording/bag_records.hpp"

#include <fmt/format.h>

namespace modebank::bag {

namespace {

constexpr std::uint32_t most_header_bytes = 1 << 20;

/// Positions of a record's parts.
struct Extent {
  std::uint64_t header_at = 0, header_bytes = 0, data_at = 0, data_bytes = 0;
};

Extent extent_at(ByteSource& bytes, std::uint64_t at, std::uint64_t end) {
  Extent extent;
  const auto number_at = [&](std::uint64_t place) {
    if (end - place < 4) throw Damage(at, "it ends within a record");
    return little_endian<std::uint32_t>(bytes.view(place, 4));
  };
  extent.header_at = at + 4;
  extent.header_bytes = number_at(at);
  if (extent.header_bytes > most_header_bytes)
    throw Damage(
        at, fmt::format("a record's header of {} bytes is larger than {}", extent.header_bytes, most_header_bytes));
  if (extent.header_bytes > end - extent.header_at) throw Damage(at, "it ends within a record");
  extent.data_bytes = number_at(extent.header_at + extent.header_bytes);
  extent.data_at = extent.header_at + extent.header_bytes + 4;
  if (extent.data_bytes > end - extent.data_at) throw Damage(at, "it ends within a record");
  return extent;
}

std::uint8_t op_of(std::string_view fields, std::uint64_t at) {
  const auto op = find_field(fields, "op", at);
  if (!op || op->size() != 1) throw Damage(at, "a record has no type");
  return static_cast<std::uint8_t>(op->front());
}

std::int64_t time_of(std::string_view value, std::uint64_t at) {
  if (value.size() != 8) throw Damage(at, "a time has the wrong size");
  return std::int64_t{little_endian<std::uint32_t>(value)} * 1'000'000'000 +
         little_endian<std::uint32_t>(value.substr(4));
}

}  // namespace

std::optional<std::string_view> find_field(std::string_view fields, std::string_view name, std::uint64_t at) {
  FieldReader reader(fields, at);
  while (!reader.done()) {
    const std::string_view field = reader.text();
    const std::size_t sign = field.find('=');
    if (sign == std::string_view::npos) throw Damage(at, "a record's header is not a list of fields");
    if (field.substr(0, sign) == name) return field.substr(sign + 1);
  }
  return {};
}

std::string_view Record::field(std::string_view name) const {
  const auto value = find_field(header, name, at);
  if (!value) throw Damage(at, fmt::format("a record has no field \"{}\"", name));
  return *value;
}

std::int64_t Record::time_ns(std::string_view name) const { return time_of(field(name), at); }

Record read_record(ByteSource& bytes, std::uint64_t at, std::uint64_t end) {
  const Extent extent = extent_at(bytes, at, end);
  Record record;
  record.at = at;
  record.data_at = extent.data_at;
  record.data_bytes = extent.data_bytes;
  record.header = bytes.view(extent.header_at, extent.header_bytes);
  record.op = static_cast<Op>(op_of(record.header, at));
  return record;
}

RecordHead read_head(ByteSource& bytes, std::uint64_t at, std::uint64_t end) {
  const Extent extent = extent_at(bytes, at, end);
  const std::string_view header = bytes.view(extent.header_at, extent.header_bytes);
  RecordHead head;
  head.at = at;
  head.payload_at = extent.data_at;
  head.payload_bytes = extent.data_bytes;
  head.end = extent.data_at + extent.data_bytes;
  const auto op = static_cast<Op>(op_of(header, at));
  if (op != Op::message && op != Op::connection) return head;
  head.kind = op == Op::message ? RecordHead::Kind::message : RecordHead::Kind::connection;
  const auto connection = find_field(header, "conn", at);
  if (!connection || connection->size() != 4) throw Damage(at, "a record does not name its connection");
  head.connection = little_endian<std::uint32_t>(*connection);
  if (op != Op::message) return head;
  const auto time = find_field(header, "time", at);
  if (!time) throw Damage(at, "a message has no time");
  head.receive_ns = time_of(*time, at);
  return head;
}

}  // namespace modebank::bag
