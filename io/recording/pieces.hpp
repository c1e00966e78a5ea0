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

/// A stretch of a file that holds records: a chunk, or records that stand outside chunks.
struct Piece {
  std::uint64_t begin = 0, end = 0;  ///< of the content, as it lies in the file
  Compression compression = Compression::none;
  std::uint64_t unpacked_bytes = 0;
  std::uint32_t crc = 0;                          ///< of what is unpacked; 0: none
  std::map<std::size_t, std::uint64_t> messages;  ///< by connection
  std::size_t given_again = 0;                    ///< numbers that were given again before it
  std::vector<std::uint64_t> gives_again;         ///< where it gives a number again: RecordHead::at
};

/// One record of a piece.
struct RecordHead {
  enum class Kind { message, connection, definition, other };
  Kind kind = Kind::other;
  std::uint32_t connection = 0;  ///< as the file numbers it
  std::int64_t receive_ns = 0;
  std::uint64_t payload_at = 0, payload_bytes = 0;  ///< of a message, or of a connection's description
  std::uint64_t at = 0, end = 0;                    ///< of the record
};

struct ConnectionName {
  std::string topic, type;
  bool operator==(const ConnectionName&) const = default;
};

/// A bag or MCAP file: pieces of records, and an index that tells them where it is sound.
class PieceFile : public Container {
 public:
  std::string visit(const std::vector<bool>& wanted, const MessageSink& sink) override;
  std::string sample(const MessageSink& sink) override;
  void close() override { file_.close(); }

 protected:
  explicit PieceFile(const std::filesystem::path& path) : path_(path), file_(path) {}

  /// Begins to read: what is damaged from there on cannot be read at all. Throws DataError, naming file and byte.
  template <class Open>
  void begin(Open&& open) {
    try {
      open();
    } catch (const Damage& damage) {
      throw DataError(damage_text(damage.at, damage.what()));
    }
  }

  /// The record at `at`, at most to `end`. Throws Damage.
  virtual RecordHead head_at(ByteSource& bytes, std::uint64_t at, std::uint64_t end) const = 0;
  /// Topic and type by a record of Kind::connection.
  virtual ConnectionName name_of(const RecordHead& head, ByteSource& bytes) const = 0;
  /// The whole of it.
  virtual Connection describe(const RecordHead& head, ByteSource& bytes) const = 0;
  /// Takes in a record of Kind::definition, which connections behind it refer to.
  virtual void define(const RecordHead& /*head*/, ByteSource& /*bytes*/) {}

  /// Takes in a record of Kind::connection. The file numbers connections; a number may come again for the same one, or
  /// be given again to another, of which later messages are then. True: the latter.
  bool learn(const RecordHead& head, ByteSource& bytes);
  /// The connection that has a number in what was read up to here.
  std::optional<std::size_t> position(std::uint32_t number) const { return position(number, given_again_.size()); }
  /// Connections and counts come from an index: records of connections in the pieces are compared with it.
  void trust_index() { from_index_ = true; }
  /// Compares those in the pieces that `sample` looks at. Throws Damage where they differ.
  void check_names();

  /// Reads the piece to learn its connections and count its messages; adds it, as far as it is whole. Throws Damage
  /// after that.
  void scan_piece(Piece piece);
  /// The same for one record of a piece that is being read.
  void count(Piece& piece, const RecordHead& head, ByteSource& bytes);
  /// Adds a piece whose messages are known. Throws Damage when there are too many.
  void add_piece(Piece piece);
  void forget_all();

  void note(std::string text) { notes_.push_back(std::move(text)); }
  /// Notes where the file stops making sense: whoever visits it stops there without saying so again.
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
  std::unordered_map<std::uint32_t, std::size_t> by_number_;        ///< the first of each number
  std::vector<std::pair<std::uint32_t, std::size_t>> given_again_;  ///< the others, in the file's order
  const Piece* visited_ = nullptr;                                  ///< the piece that a sink is given
  std::size_t visited_given_again_ = 0;                             ///< numbers that were given again before here
};

}  // namespace modebank
