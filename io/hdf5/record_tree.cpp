#include "io/hdf5/record_tree.hpp"

#include <bit>
#include <set>
#include <vector>

namespace modebank::hdf5 {

namespace {

constexpr char damaged_tree[] = "an index of links or attributes is damaged";
constexpr std::uint64_t node_bytes = 512;  // of all trees that HDF5 makes for links and attributes
constexpr std::size_t node_letters_bytes = 4, node_checksum_bytes = 4;

/// Bytes of a number up to so many.
std::size_t bytes_for(std::uint64_t most) { return static_cast<std::size_t>(std::bit_width(most) - 1) / 8 + 1; }

/// What nodes of one height may hold, the leaves' being 0.
struct Level {
  std::uint64_t most_records;
  std::uint64_t most_below;  ///< records of the node and all below it
};

class RecordTree {
 public:
  RecordTree(const BytesAt& bytes_at, const Widths& widths, const RecordKind& kind,
             const std::function<void(std::string_view)>& see)
      : bytes_at_(bytes_at), widths_(widths), kind_(kind), see_(see) {}

  void walk(haddr_t address) {
    constexpr std::uint64_t most_levels = 6;
    const std::string header = bytes_at_(address, 18 + widths_.address);
    ByteReader reader(header);
    require_start(reader, "BTHD");
    require_sound(reader.number(4) == node_bytes && reader.number(2) == kind_.bytes, damaged_tree);
    const std::uint64_t depth = reader.number(2);
    require_sound(depth < most_levels, damaged_tree);
    reader.take(2);  // when nodes are split and merged
    const haddr_t root = reader.number(widths_.address);
    const std::uint64_t records = reader.number(2);
    make_levels(static_cast<std::size_t>(depth));
    if (records > 0) walk_node(root, records, static_cast<std::size_t>(depth));
  }

 private:
  const BytesAt& bytes_at_;
  Widths widths_;
  RecordKind kind_;
  const std::function<void(std::string_view)>& see_;
  std::vector<Level> levels_;
  std::set<haddr_t> known_;

  void require_start(ByteReader& reader, std::string_view letters) const {
    require_sound(reader.take(node_letters_bytes) == letters && reader.number(1) == 0 && reader.number(1) == kind_.type,
                  damaged_tree);
  }

  std::size_t bytes_of_below(std::size_t height) const {
    return height > 1 ? bytes_for(levels_[height - 1].most_below) : 0;
  }
  std::size_t bytes_of_link(std::size_t height) const {
    return widths_.address + bytes_for(levels_.front().most_records) + bytes_of_below(height);
  }

  void make_levels(std::size_t depth) {
    constexpr std::uint64_t start_bytes = node_letters_bytes + 2 + node_checksum_bytes;
    const std::uint64_t leaf = (node_bytes - start_bytes) / kind_.bytes;
    levels_ = {{leaf, leaf}};
    for (std::size_t height = 1; height <= depth; ++height) {
      const std::size_t link = bytes_of_link(height);
      const std::uint64_t records = (node_bytes - start_bytes - link) / (kind_.bytes + link);
      levels_.push_back({records, (records + 1) * levels_.back().most_below + records});
    }
  }

  void walk_node(haddr_t address, std::uint64_t records, std::size_t height) {
    require_sound(records <= levels_[height].most_records && known_.insert(address).second, damaged_tree);
    const std::string bytes = bytes_at_(address, node_bytes);
    ByteReader reader(bytes);
    require_start(reader, height == 0 ? "BTLF" : "BTIN");
    for (std::uint64_t i = 0; i < records; ++i) see_(reader.take(kind_.bytes));
    if (height == 0) return;
    for (std::uint64_t i = 0; i <= records; ++i) {
      const haddr_t below = reader.number(widths_.address);
      const std::uint64_t count = reader.number(bytes_for(levels_.front().most_records));
      reader.take(bytes_of_below(height));
      walk_node(below, count, height - 1);
    }
  }
};

}  // namespace

void each_record(const BytesAt& bytes_at, const Widths& widths, haddr_t address, const RecordKind& kind,
                 const std::function<void(std::string_view)>& see) try {
  RecordTree(bytes_at, widths, kind, see).walk(address);
} catch (const NotKnownHere&) {
  throw Unsound{damaged_tree};
}

}  // namespace modebank::hdf5
