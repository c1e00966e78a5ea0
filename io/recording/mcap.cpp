#include "io/recording/mcap.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include "io/recording/mcap_records.hpp"
#include "modebank/base/error.hpp"

namespace modebank::mcap {

namespace {

class Mcap : public PieceFile {
 public:
  explicit Mcap(const std::filesystem::path& path) : PieceFile(path) {
    begin([this] {
      if (file_.size() < magic.size() || file_.view(0, magic.size()) != magic)
        throw DataError(fmt::format("{}: not an MCAP file (it does not begin with \"\\x89MCAP0\")", path_.string()));
      if (!try_summary()) scan();
    });
  }

 private:
  RecordHead head_at(ByteSource& bytes, std::uint64_t at, std::uint64_t end) const override {
    return read_head(bytes, at, end);
  }

  /// A file defines schemas and channels before their first message. The summary repeats the definitions.
  void define(const RecordHead& head, ByteSource& bytes) override {
    auto [number, schema] = read_schema(bytes, read_record(bytes, head.at, head.end));
    schemas_.insert_or_assign(number, std::move(schema));
  }

  ConnectionName name_of(const RecordHead& head, ByteSource& bytes) const override {
    const Channel channel = read_channel(bytes, read_record(bytes, head.at, head.end));
    const auto schema = schemas_.find(channel.schema);
    return {channel.topic, schema == schemas_.end() ? "" : schema->second.name};
  }

  Connection describe(const RecordHead& head, ByteSource& bytes) const override {
    const Channel channel = read_channel(bytes, read_record(bytes, head.at, head.end));
    Connection connection;
    connection.topic = channel.topic;
    connection.encoding_name = channel.encoding;
    if (channel.encoding == "cdr") connection.encoding = Connection::Encoding::cdr;
    if (channel.encoding == "ros1") connection.encoding = Connection::Encoding::ros1;
    if (const auto schema = schemas_.find(channel.schema); schema != schemas_.end()) {
      connection.type = schema->second.name;
      connection.definition = schema->second.text;
      connection.definition_form = schema->second.encoding;
    }
    return connection;
  }

  struct Footer {
    std::uint64_t at = 0, summary_at = 0, summary_end = 0;
    std::uint32_t crc = 0;
  };

  /// Reads the position of the summary from the footer at the end of the file. Throws Damage if the footer is missing.
  Footer read_footer() {
    constexpr std::uint64_t footer_bytes = 9 + 20;
    if (file_.size() < footer_bytes + 2 * magic.size()) throw Damage(file_.size(), "it ends too soon");
    Footer footer;
    footer.at = file_.size() - magic.size() - footer_bytes;
    if (file_.view(footer.at + footer_bytes, magic.size()) != magic)
      throw Damage(footer.at, "it does not end with MCAP's magic bytes");
    const Record record = read_record(file_, footer.at, footer.at + footer_bytes);
    if (record.op != Op::footer || record.content_bytes != 20) throw Damage(footer.at, "there is no footer");
    FieldReader fields(file_.view(record.content_at, 20), record.content_at);
    footer.summary_at = fields.number<std::uint64_t>();
    const auto offsets_at = fields.number<std::uint64_t>();
    footer.crc = fields.number<std::uint32_t>();
    footer.summary_end = offsets_at == 0 ? footer.at : offsets_at;
    if (footer.summary_at < magic.size() || footer.summary_at > footer.summary_end || footer.summary_end > footer.at)
      throw Damage(footer.at, "there is no summary");
    return footer;
  }

  void check_crc(const Footer& footer) {
    if (footer.crc == 0) return;
    constexpr std::uint64_t block_bytes = 1 << 16, crc_bytes = 4;
    const std::uint64_t end = footer.at + 9 + 20 - crc_bytes;
    uLong crc = 0;
    for (std::uint64_t at = footer.summary_at; at < end; at += block_bytes) {
      const std::string_view block = file_.view(at, std::min(block_bytes, end - at));
      crc = crc32(crc, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(block.size()));
    }
    if (crc != footer.crc) throw Damage(footer.at, "the summary has another checksum");
  }

  /// Reads the summary. Returns false unless the summary covers every message. It does so if all messages are in chunks
  /// and the index lists the channels of every chunk.
  bool try_summary() {
    try {
      const Footer footer = read_footer();
      check_crc(footer);
      std::vector<Record> chunks;
      std::optional<std::uint64_t> messages;
      for (std::uint64_t at = footer.summary_at; at < footer.summary_end;) {
        const Record record = read_record(file_, at, footer.summary_end);
        if (record.op == Op::schema) define(read_head(file_, at, record.end()), file_);
        if (record.op == Op::channel && learn(read_head(file_, at, record.end()), file_))
          throw Damage(at, "two channels have one number");
        if (record.op == Op::chunk_index) chunks.push_back(record);
        if (record.op == Op::statistics) messages = read_message_count(file_, record);
        at = record.end();
      }
      std::uint64_t found = 0, least_at = 0;
      for (const Record& record : chunks) least_at = add_chunk(read_chunk_index(file_, record), least_at, found);
      if (messages == found) {
        trust_index();
        check_names();
        return true;
      }
    } catch (const Damage&) {
    }
    forget_all();
    schemas_.clear();
    return false;
  }

  /// Adds a chunk that the index lists. Returns the position of the chunk's end.
  std::uint64_t add_chunk(const ChunkIndex& index, std::uint64_t least_at, std::uint64_t& found) {
    if (index.chunk_at < least_at) throw Damage(index.chunk_at, "chunks are not in order");
    if (index.chunk_at >= file_.size()) throw Damage(index.chunk_at, "a chunk is beyond the end");
    const Record chunk = read_record(file_, index.chunk_at, file_.size());
    if (chunk.op != Op::chunk || chunk.end() - chunk.at != index.chunk_bytes)
      throw Damage(index.chunk_at, "there is no such chunk");
    Piece piece = read_chunk(file_, chunk);
    for (const auto& [channel, at] : index.message_indexes) {
      if (at >= file_.size()) throw Damage(index.chunk_at, "a message index is beyond the end");
      const Record record = read_record(file_, at, file_.size());
      if (record.op != Op::message_index || record.content_bytes < 6) throw Damage(at, "there is no message index");
      FieldReader fields(file_.view(record.content_at, 6), record.content_at);
      const auto connection = fields.number<std::uint16_t>() == channel ? position(channel) : std::nullopt;
      if (!connection) throw Damage(at, "there is another message index");
      constexpr std::uint32_t entry_bytes = 16;
      const std::uint64_t messages = fields.number<std::uint32_t>() / entry_bytes;
      piece.messages[*connection] = messages;
      connections_[*connection].messages += messages;
      found += messages;
    }
    add_piece(std::move(piece));
    return chunk.end();
  }

  /// Reads every record. Used if the summary is incomplete.
  void scan() {
    std::uint64_t at = magic.size();
    Piece loose;  // collects the messages that are in no chunk
    const auto close = [&] {
      if (loose.end > loose.begin) add_piece(loose);
      loose = {at, at, Compression::none, 0, 0, {}, 0, {}};
    };
    try {
      bool ended = false;
      close();
      while (!ended && at < file_.size()) {
        const Record record = read_record(file_, at, file_.size());
        if (record.op == Op::chunk) {
          close();
          scan_piece(read_chunk(file_, record));
          at = record.end();
          close();
          continue;
        }
        count(loose, read_head(file_, at, file_.size()), file_);
        at = loose.end = record.end();
        constexpr std::uint64_t stretch_bytes = 16 << 20;
        if (loose.end - loose.begin > stretch_bytes) close();
        ended = record.op == Op::data_end || record.op == Op::footer;
      }
      close();
      if (!ended) throw Damage(file_.size(), "it ends before its data do (the recording was cut off)");
    } catch (const Damage& damage) {
      if (loose.end > loose.begin) add_piece(loose);
      scan_cut_chunk(at);
      if (connections_.empty()) throw;
      note_damage(damage);
    }
  }

  /// A chunk that is cut off by the end of the file still contains complete messages.
  void scan_cut_chunk(std::uint64_t at) try {
    constexpr std::uint64_t front_bytes = 9;
    if (at >= file_.size() || file_.size() - at < front_bytes) return;
    const std::string_view front = file_.view(at, front_bytes);
    const auto declared = little_endian<std::uint64_t>(front.substr(1));
    if (static_cast<Op>(front[0]) != Op::chunk || declared <= file_.size() - at - front_bytes) return;
    scan_piece(read_cut_chunk(file_, at + front_bytes));
  } catch (const Damage&) {
  }

  std::map<std::uint16_t, Schema> schemas_;
};

}  // namespace

}  // namespace modebank::mcap

namespace modebank {

std::unique_ptr<Container> open_mcap(const std::filesystem::path& path) { return std::make_unique<mcap::Mcap>(path); }

}  // namespace modebank
