#include "io/recording/pieces.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <set>

namespace modebank {

bool PieceFile::learn(const RecordHead& head, ByteSource& bytes) {
  constexpr std::size_t most_given_again = 4096;  // upper limit, because every message searches this list
  const auto known = position(head.connection);
  if (known) {
    const Connection& other = connections_[*known];
    if (name_of(head, bytes) == ConnectionName{other.topic, other.type}) return false;
  }
  if (connections_.size() == most_connections || given_again_.size() == most_given_again)
    throw Damage(head.at, fmt::format("it has more than {} connections", connections_.size()));
  connections_.push_back(describe(head, bytes));
  if (known)
    given_again_.emplace_back(head.connection, connections_.size() - 1);
  else
    by_number_.emplace(head.connection, connections_.size() - 1);
  return known.has_value();
}

std::optional<std::size_t> PieceFile::position(std::uint32_t number, std::size_t given_again) const {
  while (given_again-- > 0)
    if (given_again_[given_again].first == number) return given_again_[given_again].second;
  const auto found = by_number_.find(number);
  return found == by_number_.end() ? std::nullopt : std::optional(found->second);
}

std::size_t PieceFile::known(const RecordHead& head, std::size_t given_again) const {
  if (const auto connection = position(head.connection, given_again)) return *connection;
  throw Damage(head.payload_at, fmt::format("connection {} is not described", head.connection));
}

void PieceFile::forget_all() {
  pieces_.clear();
  connections_.clear();
  by_number_.clear();
  given_again_.clear();
  from_index_ = names_differ_ = false;
}

std::string PieceFile::damage_text(std::uint64_t at, const std::string& what) const {
  return fmt::format("{}: damaged at byte {}: {}", path_.string(), at, what);
}

void PieceFile::note_damage(const Damage& damage) {
  damage_noted_ = true;
  note(damage_text(damage.at, damage.what()) + "; data before that are read");
}

void PieceFile::walk(ByteSource& bytes, std::uint64_t begin, std::uint64_t end, const HeadSink& sink) const {
  for (std::uint64_t at = begin; at < end;) {
    const RecordHead head = head_at(bytes, at, end);
    sink(head, bytes);
    at = head.end;
  }
}

void PieceFile::unpack_piece(const Piece& piece, Unpacking& unpacking) const {
  const auto bytes = static_cast<std::size_t>(piece.end - piece.begin);
  unpacking.packed.reserve(bytes, 0);
  const std::size_t got = file_.read(piece.begin, bytes, unpacking.packed.data());
  unpacking.result = unpack(piece.compression, {unpacking.packed.data(), got}, piece.unpacked_bytes, unpacking.content);
  if (!unpacking.result.failure.empty() || piece.crc == 0) return;
  const std::string_view content = unpacking.result.bytes;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size()));
  if (crc != piece.crc) unpacking.result = {{}, "the checksum of its content is wrong"};
}

void PieceFile::walk_unpacked(const Piece& piece, const Unpacked& unpacked, const HeadSink& sink) const {
  MemoryBytes memory(unpacked.bytes);
  try {
    walk(memory, 0, memory.size(), sink);
  } catch (const Damage& damage) {
    const std::string& why = unpacked.failure.empty() ? damage.what() : unpacked.failure;
    throw Damage(piece.begin, fmt::format("{} (byte {} of the data unpacked from there)", why, damage.at));
  }
  if (!unpacked.failure.empty()) throw Damage(piece.begin, unpacked.failure);
}

void PieceFile::add_piece(Piece piece) {
  constexpr std::size_t most_pieces = 1 << 20;
  if (pieces_.size() == most_pieces) throw Damage(piece.begin, fmt::format("it has more than {} chunks", most_pieces));
  piece.given_again = given_again_.size() - piece.gives_again.size();
  pieces_.push_back(std::move(piece));
}

void PieceFile::count(Piece& piece, const RecordHead& head, ByteSource& bytes) {
  if (head.kind == RecordHead::Kind::definition) define(head, bytes);
  if (head.kind == RecordHead::Kind::connection && learn(head, bytes)) piece.gives_again.push_back(head.at);
  if (head.kind != RecordHead::Kind::message) return;
  const std::size_t connection = known(head, given_again_.size());
  ++piece.messages[connection];
  ++connections_[connection].messages;
}

void PieceFile::scan_piece(Piece piece) {
  add_piece(std::move(piece));
  Piece& added = pieces_.back();
  const HeadSink sink = [&](const RecordHead& head, ByteSource& bytes) { count(added, head, bytes); };
  if (added.compression == Compression::none) return walk(file_, added.begin, added.end, sink);
  Unpacking unpacking;
  unpack_piece(added, unpacking);
  walk_unpacked(added, unpacking.result, sink);
}

std::string PieceFile::visit_pieces(const std::vector<const Piece*>& pieces, const HeadSink& sink) {
  // Compressed pieces are decompressed in parallel, in batches of this size. Their content is then read in order.
  constexpr std::uint64_t batch_bytes = 16 << 20;
  constexpr std::size_t batch_pieces = 8;
  std::vector<Unpacking> unpackings(batch_pieces);
  const auto begin_piece = [&](const Piece& piece) {
    visited_ = &piece;
    visited_given_again_ = piece.given_again;
  };
  file_.open();
  try {
    for (std::size_t first = 0; first < pieces.size();) {
      if (pieces[first]->compression == Compression::none) {
        const Piece& piece = *pieces[first++];
        begin_piece(piece);
        walk(file_, piece.begin, piece.end, sink);
        continue;
      }
      std::size_t count = 0;
      for (std::uint64_t bytes = 0; first + count < pieces.size() && count < batch_pieces; ++count) {
        const Piece& piece = *pieces[first + count];
        bytes += piece.end - piece.begin + piece.unpacked_bytes;
        if (piece.compression == Compression::none || (count > 0 && bytes > batch_bytes)) break;
      }
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { unpack_piece(*pieces[first + i], unpackings[i]); });
      for (std::size_t i = 0; i < count; ++i) {
        begin_piece(*pieces[first + i]);
        walk_unpacked(*pieces[first + i], unpackings[i].result, sink);
      }
      first += count;
    }
  } catch (const Damage& damage) {
    return damage_noted_ ? "" : damage_text(damage.at, damage.what());
  }
  return {};
}

void PieceFile::check_name(const RecordHead& head, ByteSource& bytes) {
  const auto connection = position(head.connection, visited_given_again_);
  if (!connection) return;  // the index does not list connections without messages
  const Connection& told = connections_[*connection];
  const ConnectionName name = name_of(head, bytes);
  names_differ_ = name != ConnectionName{told.topic, told.type};
  if (names_differ_)
    throw Damage(head.at, fmt::format("connection {} is {} ({}) here, but {} ({}) in the index", head.connection,
                                      name.topic, name.type, told.topic, told.type));
}

PieceFile::HeadSink PieceFile::message_sink(const std::function<bool(std::size_t)>& wanted, const MessageSink& sink) {
  return [this, wanted, sink](const RecordHead& head, ByteSource& bytes) {
    if (head.kind == RecordHead::Kind::connection) {
      const std::vector<std::uint64_t>& again = visited_->gives_again;
      visited_given_again_ += std::count(again.begin(), again.end(), head.at) > 0 ? 1 : 0;
      if (from_index_) check_name(head, bytes);
    }
    if (head.kind != RecordHead::Kind::message) return;
    const std::size_t connection = known(head, visited_given_again_);
    if (!wanted(connection)) return;
    if (head.payload_bytes > most_message_bytes)
      throw Damage(head.payload_at,
                   fmt::format("a message of {} bytes is larger than {}", head.payload_bytes, most_message_bytes));
    sink({connection, head.receive_ns, bytes.view(head.payload_at, head.payload_bytes)});
  };
}

std::string PieceFile::visit(const std::vector<bool>& wanted, const MessageSink& sink) {
  std::vector<const Piece*> pieces;
  for (const Piece& piece : pieces_)
    if (std::any_of(piece.messages.begin(), piece.messages.end(), [&](const auto& m) { return wanted[m.first]; }))
      pieces.push_back(&piece);
  return visit_pieces(pieces, message_sink([&](std::size_t connection) { return wanted[connection]; }, sink));
}

std::map<std::size_t, std::set<std::size_t>> PieceFile::sampled_pieces() const {
  // The pieces that contain the first or the last message of a connection, for each connection.
  std::vector<std::size_t> first(connections_.size(), pieces_.size()), last(connections_.size(), pieces_.size());
  for (std::size_t p = 0; p < pieces_.size(); ++p)
    for (const auto& [connection, messages] : pieces_[p].messages) {
      if (first[connection] == pieces_.size()) first[connection] = p;
      last[connection] = p;
    }
  std::map<std::size_t, std::set<std::size_t>> connections;
  for (std::size_t c = 0; c < connections_.size(); ++c) {
    connections[first[c]].insert(c);
    connections[last[c]].insert(c);
  }
  connections.erase(pieces_.size());
  return connections;
}

void PieceFile::check_names() {
  const auto none = [](std::size_t) { return false; };
  for (const auto& [piece, here] : sampled_pieces()) {
    visit_pieces({&pieces_[piece]}, message_sink(none, {}));
    if (names_differ_) throw Damage(pieces_[piece].begin, "a chunk has other connections than the index");
  }
}

std::string PieceFile::sample(const MessageSink& sink) {
  for (const auto& [piece, here] : sampled_pieces()) {
    const auto wanted = [&, &chosen = here](std::size_t connection) { return chosen.count(connection) > 0; };
    if (std::string failure = visit_pieces({&pieces_[piece]}, message_sink(wanted, sink)); !failure.empty())
      return failure;
  }
  return {};
}

}  // namespace modebank
