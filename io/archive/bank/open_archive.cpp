#include "io/archive/bank/open_archive.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <system_error>

#include "io/files/sha256.hpp"
#include "io/hdf5/array.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr std::size_t hash_bytes = 64;

}  // namespace

UserBlock make_user_block(std::string_view content_sha256) {
  assert(content_sha256.size() == hash_bytes);
  UserBlock block{};
  std::copy(content_sha256.begin(), content_sha256.end(), block.begin());
  return block;
}

std::vector<std::string> user_block_problems(const UserBlock& block, std::string_view content_sha256) {
  const std::string_view stored(block.data(), hash_bytes);
  std::vector<std::string> problems;
  if (!is_sha256(stored))
    problems.push_back("the user block holds no SHA-256 in bytes 0-63: damaged, or not a modebank archive");
  else if (stored != content_sha256)
    problems.push_back("the content's SHA-256 is " + std::string(content_sha256) + ", the user block says " +
                       std::string(stored) + ": the file was damaged or changed after it was written");
  const auto odd = std::find_if(block.begin() + hash_bytes, block.end(), [](char c) { return c != '\0'; });
  if (odd != block.end())
    problems.push_back("byte " + std::to_string(odd - block.begin()) + " of the user block is not zero");
  return problems;
}

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_reading() { throw DataError("cannot read the file: " + std::generic_category().message(errno)); }

/// One opening of a file, through which it is hashed and handed to HDF5: a file that takes its name in between is not
/// the one that was judged. Nothing but a regular file is waited for or read.
class OpenedFile {
 public:
  explicit OpenedFile(const fs::path& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (descriptor_ < 0) throw DataError("cannot open the file: " + std::generic_category().message(errno));
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(descriptor_);
      throw DataError(S_ISDIR(status.st_mode) ? "is a folder, not an archive" : "is not a regular file");
    }
    bytes_ = static_cast<std::uintmax_t>(status.st_size);
  }
  ~OpenedFile() { ::close(descriptor_); }
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;

  std::uintmax_t bytes() const { return bytes_; }
  /// How many of `count` bytes at the offset there are.
  std::size_t read(char* to, std::size_t count, std::uintmax_t offset) const {
    std::size_t done = 0;
    while (done < count) {
      const ssize_t got = ::pread(descriptor_, to + done, count - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail_reading();
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
    }
    return done;
  }
  std::string bytes_at(std::uintmax_t offset, std::size_t count) const {
    std::string text(count, '\0');
    text.resize(read(text.data(), count, offset));
    return text;
  }
  /// A name that leads to this very file, whatever its own leads to by now; the path where there is no /proc.
  std::string name(const fs::path& path) const {
    const std::string own = "/proc/self/fd/" + std::to_string(descriptor_);
    std::error_code error;
    return fs::exists(own, error) ? own : path.string();
  }

 private:
  int descriptor_;
  std::uintmax_t bytes_ = 0;
};

/// Of everything after the user block.
std::string content_hash(const OpenedFile& file) {
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  std::uintmax_t offset = user_block_bytes;
  while (const std::size_t got = file.read(buffer.data(), buffer.size(), offset)) {
    hash.update(buffer.data(), got);
    offset += got;
  }
  return hash.hex();
}

std::vector<std::string> hash_problems(const OpenedFile& file) {
  UserBlock block{};
  if (file.read(block.data(), block.size(), 0) < block.size()) return {"the file is shorter than its user block"};
  return user_block_problems(block, content_hash(file));
}

}  // namespace

std::string content_hash(const fs::path& path) { return content_hash(OpenedFile(path)); }

std::vector<std::string> hash_problems(const fs::path& path) try {
  return hash_problems(OpenedFile(path));
} catch (const DataError& error) {
  return {error.what()};
}

namespace {

constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

/// Where HDF5's superblock, which the signature begins, says that the file ends; 0 where it is not one that we write.
std::uintmax_t stated_end(const OpenedFile& file) {
  constexpr std::size_t version_at = 8, address_size_at = 9, end_at = 28, address_bytes = 8;
  const std::string superblock = file.bytes_at(user_block_bytes, end_at + address_bytes);
  if (superblock.size() < end_at + address_bytes || superblock[version_at] != 2 ||
      superblock[address_size_at] != address_bytes)
    return 0;
  std::uintmax_t end = 0;
  for (std::size_t i = address_bytes; i-- > 0;) end = end << 8 | static_cast<unsigned char>(superblock[end_at + i]);
  return end;
}

/// Before HDF5 sees the file: most foreign files are told apart here, and those that were cut off.
void check_signature(const OpenedFile& file) {
  if (file.bytes() == 0) throw DataError("the file is empty");
  if (file.bytes_at(user_block_bytes, hdf5_signature.size()) == hdf5_signature) {
    if (const std::uintmax_t end = stated_end(file); file.bytes() < end)
      throw DataError("truncated file: " + std::to_string(file.bytes()) + " of " + std::to_string(end) +
                      " bytes are there");
    return;
  }
  if (file.bytes_at(0, hdf5_signature.size()) == hdf5_signature)
    throw DataError("not a modebank archive (an HDF5 file of another program)");
  throw DataError("not a modebank archive");
}

std::string root_text(const hdf5::Handle& root, const std::string& name) {
  if (!hdf5::has_attribute(root.id(), name)) return {};
  const hdf5::StoredArray attribute(root.id(), hdf5::Place::attribute, name);
  return attribute.elements() == 1 ? attribute.texts().front() : std::string();
}

/// The number before the first dot; -1 when there is none.
int major_version(const std::string& version) {
  int major = -1;
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), major);
  const bool complete = error == std::errc() && (end == version.data() + version.size() || *end == '.');
  return complete && major >= 0 ? major : -1;
}

void check_schema(const hdf5::Handle& root) {
  if (root_text(root, "format") != archive_format)
    throw DataError("not a modebank archive (root attribute format is '" + root_text(root, "format") + "')");
  const std::string version = root_text(root, "schema_version");
  const int major = major_version(version);
  if (major < 0) throw DataError("schema_version '" + version + "' is not a version");
  if (major > major_version(schema_version))
    throw DataError("the archive's schema " + version + " is newer than " + schema_version +
                    ", which this version of modebank reads");
  if (major < major_version(schema_version))
    throw DataError(
        "the archive's schema " + version + " is older than " + schema_version +
        ": scores had other names then (tail_above, tail_below) and fewer competitors; run its /config again");
}

void check_hash(const OpenedFile& file) {
  if (const std::vector<std::string> problems = hash_problems(file); !problems.empty())
    throw DataError("damaged: " + problems.front());
}

}  // namespace

void require_readable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw ConfigurationError(path.string() + ": no such file");
  if (error) throw DataError(path.string() + ": " + error.message());
  if (fs::is_directory(status)) throw DataError(path.string() + ": is a folder, not an archive");
  if (!fs::is_regular_file(status)) throw DataError(path.string() + ": is not a regular file");
}

hdf5::Handle open_archive(const fs::path& path, HashCheck hash) {
  require_readable(path);
  try {
    const OpenedFile opened(path);
    check_signature(opened);
    if (hash == HashCheck::before) check_hash(opened);
    hdf5::Handle file = hdf5::open_file(opened.name(path));
    check_schema(open_root(file));
    return file;
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

hdf5::Handle open_root(const hdf5::Handle& file) { return hdf5::open_group(file.id(), "/"); }

}  // namespace modebank
