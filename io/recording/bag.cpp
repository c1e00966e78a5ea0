#include "io/recording/bag.hpp"

#include <fmt/format.h>

#include "io/recording/bag_records.hpp"
#include "modebank/base/error.hpp"

namespace modebank::bag {

namespace {

class Bag : public PieceFile {
 public:
  explicit Bag(const std::filesystem::path& path) : PieceFile(path) {
    begin([this] {
      const Record header = read_header();
      if (!try_index(header)) scan();
    });
  }

 private:
  RecordHead head_at(ByteSource& bytes, std::uint64_t at, std::uint64_t end) const override {
    return read_head(bytes, at, end);
  }

  /// The publisher's description of the connection. Its fields have the form of a record's header.
  static std::string publisher_fields(const RecordHead& head, ByteSource& bytes) {
    if (head.payload_bytes > most_definition_bytes)
      throw Damage(head.payload_at, fmt::format("a definition of {} bytes is larger than {}", head.payload_bytes,
                                                most_definition_bytes));
    return std::string(bytes.view(head.payload_at, head.payload_bytes));
  }

  static std::string text_of(const std::string& fields, std::string_view name, const RecordHead& head) {
    return std::string(find_field(fields, name, head.payload_at).value_or(""));
  }

  /// The recorded topic is in the record's header. The publisher's description is not used: publishers in C++ omit the
  /// topic there, and a publisher whose topic was remapped states another topic.
  ConnectionName name_of(const RecordHead& head, ByteSource& bytes) const override {
    const std::string header = read_record(bytes, head.at, head.end).header, fields = publisher_fields(head, bytes);
    const auto topic = find_field(header, "topic", head.at);
    return {topic ? std::string(*topic) : text_of(fields, "topic", head), text_of(fields, "type", head)};
  }

  Connection describe(const RecordHead& head, ByteSource& bytes) const override {
    Connection connection;
    const ConnectionName name = name_of(head, bytes);
    connection.topic = name.topic;
    connection.type = name.type;
    connection.definition = text_of(publisher_fields(head, bytes), "message_definition", head);
    connection.encoding = Connection::Encoding::ros1;
    connection.encoding_name = "ros1";
    connection.definition_form = "ros1msg";
    return connection;
  }

  Record read_header() {
    if (file_.size() < magic.size() || file_.view(0, magic.size()) != magic) {
      constexpr std::string_view family = "#ROSBAG V";
      if (file_.size() > family.size() && file_.view(0, family.size()) == family)
        throw DataError(fmt::format(
            "{}: this bag has format {}, but only 2.0 is supported; convert it with `rosbag fix`", path_.string(),
            file_.view(family.size(), std::min<std::uint64_t>(3, file_.size() - family.size()))));
      throw DataError(fmt::format("{}: not a ROS 1 bag (it does not begin with \"#ROSBAG V2.0\")", path_.string()));
    }
    const Record header = read_record(file_, magic.size(), file_.size());
    if (header.op != Op::header) throw Damage(header.at, "its first record is not the bag's header");
    const auto encryptor = find_field(header.header, "encryptor", header.at);
    if (encryptor && !encryptor->empty())
      throw DataError(fmt::format("{}: the bag is encrypted ({}); record or copy it without encryption", path_.string(),
                                  *encryptor));
    return header;
  }

  Piece chunk(const Record& record) const {
    Piece piece;
    piece.begin = record.data_at;
    piece.end = record.end();
    piece.unpacked_bytes = record.number<std::uint32_t>("size");
    const std::string_view compression = record.field("compression");
    if (compression == "bz2")
      piece.compression = Compression::bz2;
    else if (compression == "lz4")
      piece.compression = Compression::lz4;
    else if (compression != "none")
      throw Damage(record.at,
                   fmt::format("the compression \"{}\" is not supported (only none, bz2 and lz4)", compression));
    if (piece.compression != Compression::none && std::max(piece.unpacked_bytes, record.data_bytes) > most_chunk_bytes)
      throw Damage(record.at, fmt::format("a chunk of {} bytes is larger than {}",
                                          std::max(piece.unpacked_bytes, record.data_bytes), most_chunk_bytes));
    return piece;
  }

  /// Reads the index at the end of the file. Returns false unless the whole index agrees with its chunks.
  bool try_index(const Record& header) {
    try {
      const auto index_at = header.number<std::uint64_t>("index_pos");
      if (index_at < header.end() || index_at > file_.size()) return false;
      if (read_index(index_at) == header.number<std::uint32_t>("chunk_count")) {
        trust_index();
        return true;
      }
    } catch (const Damage&) {
    }
    forget_all();
    return false;
  }

  std::uint64_t read_index(std::uint64_t at) {
    std::uint64_t chunks = 0, expected_at = 0;
    while (at < file_.size()) {
      const Record record = read_record(file_, at, file_.size());
      if (record.op == Op::connection) {
        if (learn(read_head(file_, at, file_.size()), file_)) throw Damage(at, "two connections have one number");
      } else if (record.op == Op::chunk_info) {
        expected_at = check_chunk(record, expected_at), ++chunks;
      } else {
        throw Damage(at, "the index holds another record");
      }
      at = record.end();
    }
    return chunks;
  }

  /// Adds a chunk that the index lists. After the chunk comes the chunk's own index, which must contain the same
  /// numbers of messages.
  std::uint64_t check_chunk(const Record& info, std::uint64_t least_at) {
    const auto at = info.number<std::uint64_t>("chunk_pos");
    if (at < least_at || at >= info.at) throw Damage(info.at, "chunks are not in order");
    const Record record = read_record(file_, at, info.at);
    if (record.op != Op::chunk) throw Damage(at, "there is no chunk");
    Piece piece = chunk(record);
    const std::string counts(file_.view(info.data_at, std::min<std::uint64_t>(info.data_bytes, most_definition_bytes)));
    FieldReader reader(counts, info.data_at);
    for (auto left = info.number<std::uint32_t>("count"); left > 0; --left) {
      const auto number = reader.number<std::uint32_t>();
      const auto messages = reader.number<std::uint32_t>();
      const auto connection = position(number);
      if (!connection) throw Damage(info.at, "a connection is not described");
      piece.messages[*connection] += messages;
      connections_[*connection].messages += messages;
    }
    std::map<std::size_t, std::uint64_t> indexed;
    std::uint64_t next = record.end();
    for (std::size_t i = 0; i < piece.messages.size(); ++i) {
      const Record index = read_record(file_, next, info.at);
      const auto connection = index.op == Op::index ? position(index.number<std::uint32_t>("conn")) : std::nullopt;
      if (!connection) throw Damage(next, "a chunk's index is missing");
      indexed[*connection] += index.number<std::uint32_t>("count");
      next = index.end();
    }
    if (indexed != piece.messages) throw Damage(info.at, "two indexes differ");
    add_piece(std::move(piece));
    return next;
  }

  /// Reads every record. Used if the index is unusable.
  void scan() {
    note(
        fmt::format("{}: its index is missing or damaged (the recording was cut off, or `rosbag reindex` was not run), "
                    "so every record is read",
                    path_.string()));
    std::uint64_t at = magic.size();
    try {
      Piece loose;
      while (at < file_.size()) {
        const RecordHead head = read_head(file_, at, file_.size());
        if (head.kind == RecordHead::Kind::message) {
          loose = {at, head.end, Compression::none, head.end - at, 0, {}, 0, {}};
          count(loose, head, file_);
          add_piece(std::move(loose));
        } else if (head.kind == RecordHead::Kind::connection) {
          learn(head, file_);
        } else if (const Record record = read_record(file_, at, file_.size()); record.op == Op::chunk) {
          scan_piece(chunk(record));
        }
        at = head.end;
      }
    } catch (const Damage& damage) {
      scan_cut_chunk(at);
      if (connections_.empty()) throw;
      note_damage(damage);
    }
  }

  /// A chunk that is cut off by the end of the file may still contain complete messages.
  void scan_cut_chunk(std::uint64_t at) try {
    const auto rest = file_.size() - std::min(at, file_.size());
    if (rest < 8) return;
    const auto header_bytes = little_endian<std::uint32_t>(file_.view(at, 4));
    if (header_bytes > rest - 8) return;
    Record record;
    record.at = at;
    record.header = file_.view(at + 4, header_bytes);
    record.data_at = at + header_bytes + 8;
    record.data_bytes = file_.size() - record.data_at;
    if (record.number<std::uint8_t>("op") != static_cast<std::uint8_t>(Op::chunk)) return;
    if (little_endian<std::uint32_t>(file_.view(record.data_at - 4, 4)) <= record.data_bytes) return;
    scan_piece(chunk(record));
  } catch (const Damage&) {
  }
};

}  // namespace

}  // namespace modebank::bag

namespace modebank {

std::unique_ptr<Container> open_bag(const std::filesystem::path& path) { return std::make_unique<bag::Bag>(path); }

}  // namespace modebank
