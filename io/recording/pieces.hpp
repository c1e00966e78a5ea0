#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/recording/byte_source.hpp"
#include "io/recording/connections.hpp"
#include "io/recording/decompress.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

/// A part of a file with records. It is a chunk, or a sequence of records outside chunks.
struct Piece {
  std::uint64_t begin = 0, end = 0;  ///< positions in the file where the content begins and ends
  Compression compression = Compression::none;
  std::uint64_t unpacked_bytes = 0;
  std::uint32_t crc = 0;                          ///< checksum of the decompressed content; 0: no checksum
  std::map<std::size_t, std::uint64_t> messages;  ///< number of messages of each connection
  std::size_t given_again = 0;                    ///< number of reassigned connection numbers before this piece
  std::vector<std::uint64_t> gives_again;         ///< positions (RecordHead::at) of records that reassign a connection
                                                  ///< number
};

/// Position and type of a record in a piece.
struct RecordHead {
  enum class Kind { message, connection, definition, other };
  Kind kind = Kind::other;
  std::uint32_t connection = 0;  ///< the connection's number in the file
  std::int64_t receive_ns = 0;
  std::uint64_t payload_at = 0, payload_bytes = 0;  ///< payload of a message or of a connection's description
  std::uint64_t at = 0, end = 0;                    ///< end of the record
};

struct ConnectionName {
  std::string topic, type;
  bool operator==(const ConnectionName&) const = default;
};

/// A bag or MCAP file: pieces of records, and an index of these pieces if it is valid.
class PieceFile : public Container {
 public:
  std::string visit(const std::vector<bool>& wanted, const MessageSink& sink) override;
  std::string sample(const MessageSink& sink) override;
  void close() override { file_.close(); }

 protected:
  explicit PieceFile(const std::filesystem::path& path) : path_(path), file_(path) {}

  /// Starts reading. Throws DataError with file and byte if the beginning is damaged, because the file is then
  /// unreadable.
  template <class Open>
  void begin(Open&& open) {
    try {
      open();
    } catch (const Damage& damage) {
      throw DataError(damage_text(damage.at, damage.what()));
    }
  }

  /// The record at position `at`. It must end at or before `end`. Throws Damage.
  virtual RecordHead head_at(ByteSource& bytes, std::uint64_t at, std::uint64_t end) const = 0;
  /// Topic and type in a record of Kind::connection.
  virtual ConnectionName name_of(const RecordHead& head, ByteSource& bytes) const = 0;
  /// The complete connection that this record describes.
  virtual Connection describe(const RecordHead& head, ByteSource& bytes) const = 0;
  /// Reads a record of Kind::definition. Later connections refer to this definition.
  virtual void define(const RecordHead& /*head*/, ByteSource& /*bytes*/) {}

  /// Reads a record of Kind::connection. The record may repeat a connection under the same number. It may also reassign
  /// the number to another connection. Later messages with this number then belong to the new connection, and the
  /// function returns true.
  bool learn(const RecordHead& head, ByteSource& bytes);
  /// The connection that has this number at the current position.
  std::optional<std::size_t> position(std::uint32_t number) const { return position(number, given_again_.size()); }
  /// Uses the connections and message numbers of an index. Records of connections in the pieces are compared with the
  /// index.
  void trust_index() { from_index_ = true; }
  /// Compares the index with the connections in the pieces that `sample` reads. Throws Damage if they differ.
  void check_names();

  /// Reads a piece to find its connections and numbers of messages. Adds the piece, or its part before any damage. Then
  /// throws Damage if the piece is damaged.
  void scan_piece(Piece piece);
  /// Counts one record of the piece that is being read.
  void count(Piece& piece, const RecordHead& head, ByteSource& bytes);
  /// Adds a piece whose messages are known. Throws Damage if there are too many.
  void add_piece(Piece piece);
  void forget_all();

  void note(std::string text) { notes_.push_back(std::move(text)); }
  /// Stores the position of the damage. Visits end at this position without another message.
  void note_damage(const Damage& damage);
  std::string damage_text(std::uint64_t at, const std::string& what) const;

  std::filesystem::path path_;
  FileBytes file_;

 private:
  using HeadSink = std::function<void(const RecordHead&, ByteSource&)>;
  struct Unpacking {
    Buffer packed, content;
    Unpacked result;
  };

  void walk(ByteSource& bytes, std::uint64_t begin, std::uint64_t end, const HeadSink& sink) const;
  void unpack_piece(const Piece& piece, Unpacking& unpacking) const;
  void walk_unpacked(const Piece& piece, const Unpacked& unpacked, const HeadSink& sink) const;
  std::string visit_pieces(const std::vector<const Piece*>& pieces, const HeadSink& sink);
  HeadSink message_sink(const std::function<bool(std::size_t)>& wanted, const MessageSink& sink);
  std::map<std::size_t, std::set<std::size_t>> sampled_pieces() const;
  std::optional<std::size_t> position(std::uint32_t number, std::size_t given_again) const;
  std::size_t known(const RecordHead& head, std::size_t given_again) const;
  void check_name(const RecordHead& head, ByteSource& bytes);

  std::vector<Piece> pieces_;
  bool damage_noted_ = false, from_index_ = false, names_differ_ = false;
  std::unordered_map<std::uint32_t, std::size_t> by_number_;        ///< the first connection of each number
  std::vector<std::pair<std::uint32_t, std::size_t>> given_again_;  ///< reassigned numbers, in the order of the file
  const Piece* visited_ = nullptr;                                  ///< the piece that is being visited
  std::size_t visited_given_again_ = 0;                             ///< number of reassignments before the current
                                                                    ///< position
};

}  // namespace modebank
