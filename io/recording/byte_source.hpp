#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// Thrown if a recording is damaged from byte `at` on. The bytes before `at` are usable.
struct Damage : std::runtime_error {
  Damage(std::uint64_t at_byte, const std::string& what) : std::runtime_error(what), at(at_byte) {}
  std::uint64_t at = 0;
};

/// The little-endian number at the start of `bytes`. There must be at least sizeof(T) bytes.
template <class T>
T little_endian(std::string_view bytes) {
  static_assert(std::is_unsigned_v<T>);
  T value = 0;
  for (std::size_t i = sizeof(T); i-- > 0;)
    value = static_cast<T>(static_cast<T>(value << (sizeof(T) > 1 ? 8 : 0)) | static_cast<unsigned char>(bytes[i]));
  return value;
}

/// Bytes that are read part by part, from a file or from a chunk in memory.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// The bytes from position `at`, valid until the next call. Throws Damage if there are fewer bytes.
  std::string_view view(std::uint64_t at, std::uint64_t bytes) {
    if (at > size() || bytes > size() - at) throw Damage(at, "it ends within a record");
    return viewed(at, static_cast<std::size_t>(bytes));
  }

 private:
  virtual std::string_view viewed(std::uint64_t at, std::size_t bytes) = 0;
};

class MemoryBytes : public ByteSource {
 public:
  explicit MemoryBytes(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }

 private:
  std::string_view viewed(std::uint64_t at, std::size_t bytes) override { return bytes_.substr(at, bytes); }
  std::string_view bytes_;
};

/// A file that is read through a window. Skipped parts are not read.
class FileBytes : public ByteSource {
 public:
  /// Opens the file. Throws ConfigurationError with path and reason if the file cannot be read.
  explicit FileBytes(std::filesystem::path path);
  ~FileBytes() override;
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::uint64_t size() const override { return size_; }
  /// Closes the file until `open` is called again, because a pattern may match thousands of files.
  void close();
  void open();
  /// Copies up to `bytes` bytes without using the window. Returns the number of copied bytes. Threads may call this
  /// function at the same time.
  std::size_t read(std::uint64_t at, std::size_t bytes, char* to) const;

 private:
  std::string_view viewed(std::uint64_t at, std::size_t bytes) override;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t window_at_ = 0;
  std::size_t window_bytes_ = 0;
  std::vector<char> window_;
};

/// Reads the fields of a record one by one.
class FieldReader {
 public:
  /// `at`: position of the bytes in the file, for messages.
  explicit FieldReader(std::string_view bytes, std::uint64_t at = 0) : bytes_(bytes), at_(at) {}

  bool done() const { return bytes_.empty(); }
  std::string_view take(std::uint64_t bytes) {
    if (bytes > bytes_.size()) throw Damage(at_, "a record's field is longer than the record");
    const std::string_view taken = bytes_.substr(0, static_cast<std::size_t>(bytes));
    bytes_.remove_prefix(taken.size());
    at_ += taken.size();
    return taken;
  }
  template <class T>
  T number() {
    return little_endian<T>(take(sizeof(T)));
  }
  /// Reads a length of four bytes, then a text of this length.
  std::string_view text() { return take(number<std::uint32_t>()); }

 private:
  std::string_view bytes_;
  std::uint64_t at_ = 0;
};

}  // namespace modebank
