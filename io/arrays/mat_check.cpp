#include "io/arrays/mat_check.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>

#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

[[noreturn]] void fail(const char* what) { throw DataError(fmt::format("damaged MATLAB file: {}", what)); }

/// Bytes one after the other.
class Bytes {
 public:
  virtual ~Bytes() = default;
  /// Throws where there are fewer.
  virtual void read(char* to, std::size_t count) = 0;
  virtual void skip(std::uint64_t count) {
    std::array<char, 1 << 14> unused;
    for (; count > 0; count -= std::min<std::uint64_t>(count, unused.size()))
      read(unused.data(), std::min<std::uint64_t>(count, unused.size()));
  }
};

class FileBytes : public Bytes {
 public:
  explicit FileBytes(const std::filesystem::path& path)
      : file_(open_file(path)), left_(std::filesystem::file_size(path)) {}
  void read(char* to, std::size_t count) override {
    take(count);
    if (!file_.read(to, static_cast<std::streamsize>(count))) fail("it ends too soon");
  }
  void skip(std::uint64_t count) override {
    take(count);
    file_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
  }
  std::uint64_t left() const { return left_; }

 private:
  void take(std::uint64_t count) {
    if (count > left_) fail("a part of it is said to be larger than what is there");
    left_ -= count;
  }
  std::ifstream file_;
  std::uint64_t left_;
};

/// What a compressed element of so many bytes holds.
class UnpackedBytes : public Bytes {
 public:
  UnpackedBytes(FileBytes& packed, std::uint64_t count) : packed_(packed), left_(count) {
    if (inflateInit(&stream_) != Z_OK) throw DataError("zlib cannot begin");
  }
  ~UnpackedBytes() override { inflateEnd(&stream_); }
  void read(char* to, std::size_t count) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(count);
    while (stream_.avail_out > 0) {
      if (stream_.avail_in == 0) refill();
      const int status = inflate(&stream_, Z_NO_FLUSH);
      if (status == Z_STREAM_END && stream_.avail_out > 0) fail("a compressed part ends too soon");
      if (status != Z_OK && status != Z_STREAM_END) fail("a compressed part cannot be unpacked");
    }
  }
  /// Goes behind the element in the file.
  void finish() { packed_.skip(left_); }

 private:
  void refill() {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, buffer_.size()));
    if (count == 0) fail("a compressed part ends too soon");
    packed_.read(buffer_.data(), count);
    left_ -= count;
    stream_.next_in = reinterpret_cast<Bytef*>(buffer_.data());
    stream_.avail_in = static_cast<uInt>(count);
  }
  FileBytes& packed_;
  std::uint64_t left_;
  z_stream stream_{};
  std::array<char, 1 << 14> buffer_;
};

std::uint32_t whole(Bytes& bytes, bool swapped) {
  std::uint32_t value = 0;
  bytes.read(reinterpret_cast<char*>(&value), sizeof value);
  return swapped ? __builtin_bswap32(value) : value;
}

constexpr std::uint64_t longest_name = 4096, tag_bytes = 8;
constexpr int deepest = 64;

/// The elements of versions 6 and 7.
class Elements {
 public:
  using Classes = std::map<std::string, std::string>;

  /// `objects`: gets the classes of variables that are objects.
  Elements(Bytes& bytes, bool swapped, Classes& objects) : bytes_(bytes), swapped_(swapped), objects_(objects) {}

  /// A matrix whose tag is read, and whose content has so many bytes.
  void matrix(std::uint64_t room, int depth) {
    if (room == 0) return;  // a field that holds nothing
    if (depth > deepest) fail("its structs are nested too deeply");
    const Part flags = part(room);
    if (flags.type != flags_type || flags.bytes != tag_bytes) fail("a matrix does not say what it is");
    const std::uint32_t word = value(flags), kind = word & 0xff;
    const bool is_complex = (word & 0x800) != 0;
    rest(flags, 4);
    if (kind == opaque) return opaque_object(room, depth);
    const std::uint64_t count = extents(part(room));
    const Part called = part(room);
    if (depth > 0 && called.bytes > 0) fail("a part of a struct or cell has a name of its own");
    const std::string variable = text(called);
    if (kind == object) note_object(variable, text(part(room)), depth);
    if (kind == cell) return matrices(count, room, depth);
    if (kind == structure || kind == object) return fields(count, room, depth);
    if (kind == function) return matrices(1, room, depth);
    if (kind == sparse || kind > uint64) return bytes_.skip(room);
    for (int k = 0; k < (is_complex ? 2 : 1) && (count > 0 || room > 0); ++k) {
      const Part values = part(room);
      // A value is stored in one byte at least; text in UTF-8 may take fewer than its characters' bytes.
      if (count > values.bytes) fail("a matrix holds fewer values than it says");
      rest(values, 0);
    }
    bytes_.skip(room);
  }

  struct Tag {
    std::uint32_t type = 0;
    std::uint64_t bytes = 0;
  };
  Tag tag() {
    const std::uint32_t type = whole(bytes_, swapped_);
    return {type, whole(bytes_, swapped_)};
  }

  static constexpr std::uint32_t matrix_type = 14, compressed_type = 15;

 private:
  static constexpr std::uint32_t extents_type = 5, flags_type = 6;  // numbers of 4 bytes, with a sign and without
  enum Kind : std::uint32_t {
    cell = 1,
    structure = 2,
    object = 3,
    sparse = 5,
    uint64 = 15,
    function = 16,
    opaque = 17
  };

  /// One part of a matrix: so many bytes, and what fills the last eight; small ones stand in their tag.
  struct Part {
    std::uint32_t type = 0;
    std::uint64_t bytes = 0, padding = 0;
    std::array<char, 4> small{};
    bool is_small = false;
  };

  Bytes& bytes_;
  bool swapped_;
  Classes& objects_;

  void take(std::uint64_t& room, std::uint64_t count) {
    if (count > room) fail("a part of a matrix is larger than the matrix");
    room -= count;
  }

  /// Reads a part's tag; its content is next, unless it is small.
  Part part(std::uint64_t& room) {
    take(room, tag_bytes);
    Part result;
    const std::uint32_t first = whole(bytes_, swapped_);
    if (first >> 16 != 0) {
      result.is_small = true;
      result.type = first & 0xffff;
      result.bytes = first >> 16;
      if (result.bytes > result.small.size()) fail("a small part is too large");
      bytes_.read(result.small.data(), result.small.size());
      return result;
    }
    result.type = first;
    result.bytes = whole(bytes_, swapped_);
    result.padding = (tag_bytes - result.bytes % tag_bytes) % tag_bytes;
    take(room, result.bytes);
    // The last part of a matrix may lack what would fill it up.
    result.padding = std::min(result.padding, room);
    take(room, result.padding);
    return result;
  }

  /// The first number of a part, and what is left of it behind `used` bytes.
  std::uint32_t value(const Part& from) {
    if (!from.is_small) return whole(bytes_, swapped_);
    std::uint32_t number = 0;
    std::memcpy(&number, from.small.data(), sizeof number);
    return swapped_ ? __builtin_bswap32(number) : number;
  }
  void rest(const Part& of, std::uint64_t used) {
    if (!of.is_small) bytes_.skip(of.bytes - used + of.padding);
  }

  std::uint64_t extents(const Part& of) {
    constexpr std::uint64_t most_extents = 32;
    if (of.type != extents_type || of.is_small || of.bytes < 8 || of.bytes % 4 != 0 || of.bytes / 4 > most_extents)
      fail("a matrix has no shape");
    std::uint64_t count = 1;
    for (std::uint64_t i = 0; i < of.bytes / 4; ++i) {
      const std::uint32_t extent = whole(bytes_, swapped_);
      if (extent >> 31 != 0 || __builtin_mul_overflow(count, extent, &count)) fail("a matrix has no shape");
    }
    rest(of, of.bytes);
    return count;
  }

  std::string text(const Part& of) {
    if (of.bytes > longest_name) fail("a name is too long");
    std::string name(static_cast<std::size_t>(of.bytes), '\0');
    if (of.is_small)
      std::copy_n(of.small.begin(), name.size(), name.begin());
    else
      bytes_.read(name.data(), name.size());
    rest(of, of.bytes);
    return name;
  }

  void note_object(const std::string& variable, const std::string& made, int depth) {
    if (depth == 0) objects_[variable] = made;
  }

  /// MATLAB's class system puts the variable's name, its own and the class's before the content.
  void opaque_object(std::uint64_t room, int depth) {
    if (depth == 0) {
      const std::string variable = text(part(room));
      text(part(room));
      note_object(variable, text(part(room)), depth);
    }
    bytes_.skip(room);
  }

  void fields(std::uint64_t count, std::uint64_t room, int depth) {
    const Part length = part(room);
    if (length.type != extents_type || length.bytes != 4) fail("a struct does not tell its fields");
    const std::uint32_t longest = value(length);
    rest(length, 4);
    const Part names = part(room);
    if (names.bytes > 0 && (longest == 0 || longest > longest_name)) fail("a struct's field has no name");
    const std::uint64_t number = names.bytes == 0 ? 0 : names.bytes / longest;
    rest(names, 0);
    if (number > 0 && count > room / number) fail("a struct has fewer fields than it says");
    matrices(count * number, room, depth);
  }

  void matrices(std::uint64_t count, std::uint64_t room, int depth) {
    if (count > room / tag_bytes) fail("a struct or cell has fewer parts than it says");
    for (; count > 0; --count) {
      take(room, tag_bytes);
      const Tag inner = tag();
      if (inner.type != matrix_type) fail("a struct or cell holds what is no matrix");
      take(room, inner.bytes);
      matrix(inner.bytes, depth + 1);
      const std::uint64_t padding = std::min((tag_bytes - inner.bytes % tag_bytes) % tag_bytes, room);
      take(room, padding);
      bytes_.skip(padding);
    }
    bytes_.skip(room);
  }
};

Elements::Classes check_elements(FileBytes& file) {
  Elements::Classes objects;
  std::array<char, 128> header{};
  file.read(header.data(), header.size());
  const std::string_view order(header.data() + 126, 2);
  if (order != "IM" && order != "MI") fail("its header is another one");
  const bool swapped = (order == "MI") == (std::endian::native == std::endian::little);
  while (file.left() >= tag_bytes) {
    const Elements::Tag outer = Elements(file, swapped, objects).tag();
    if (outer.bytes > file.left()) fail("a part of it is said to be larger than what is there");
    if (outer.type == Elements::matrix_type) {
      Elements(file, swapped, objects).matrix(outer.bytes, 0);
    } else if (outer.type == Elements::compressed_type) {
      UnpackedBytes unpacked(file, outer.bytes);
      Elements elements(unpacked, swapped, objects);
      const Elements::Tag inner = elements.tag();
      if (inner.type != Elements::matrix_type) fail("a compressed part is no matrix");
      elements.matrix(inner.bytes, 0);
      unpacked.finish();
    } else {
      fail("a part of it is no matrix");
    }
  }
  return objects;
}

/// Version 4: type, rows, columns, whether complex, the name's length; the name; values.
void check_matrices(FileBytes& file) {
  while (file.left() > 0) {
    const std::uint32_t type = whole(file, false);
    constexpr std::uint32_t largest_type = 5000;
    const bool swapped = type > largest_type;
    const std::uint32_t known = swapped ? __builtin_bswap32(type) : type;
    constexpr std::array<std::uint64_t, 6> value_bytes{8, 4, 4, 2, 2, 1};
    if (known > largest_type || known / 10 % 10 >= value_bytes.size()) fail("a matrix of no known type");
    const std::uint64_t rows = whole(file, swapped), columns = whole(file, swapped);
    const std::uint64_t parts = whole(file, swapped) != 0 ? 2 : 1, name_bytes = whole(file, swapped);
    if (name_bytes == 0 || name_bytes > longest_name) fail("a name is too long");
    file.skip(name_bytes);
    std::uint64_t count = 0;
    if (__builtin_mul_overflow(rows, columns, &count) || count > file.left()) fail("a matrix is larger than the file");
    file.skip(count * parts * value_bytes[known / 10 % 10]);
  }
}

}  // namespace

std::map<std::string, std::string> check_mat(const std::filesystem::path& path) {
  try {
    FileBytes file(path);
    // Versions 6 and 7 begin with text, 4 with a type, which has a zero among its four bytes.
    std::array<char, 4> first{};
    if (file.left() >= first.size()) FileBytes(path).read(first.data(), first.size());
    if (std::find(first.begin(), first.end(), '\0') == first.end()) return check_elements(file);
    check_matrices(file);
    return {};
  } catch (const DataError& error) {
    throw DataError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace modebank
