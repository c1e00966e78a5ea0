#include "io/archive/bank/open_archive.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <fstream>
#include <system_error>

#include "io/files/read_file.hpp"
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
    problems.push_back("the user block has no SHA-256 in bytes 0-63; the file is damaged or not a modebank archive");
  else if (stored != content_sha256)
    problems.push_back("the content's SHA-256 is " + std::string(content_sha256) + ", but the user block has " +
                       std::string(stored) + "; the file was damaged or changed after it was written");
  const auto odd = std::find_if(block.begin() + hash_bytes, block.end(), [](char c) { return c != '\0'; });
  if (odd != block.end())
    problems.push_back("byte " + std::to_string(odd - block.begin()) + " of the user block is not zero");
  return problems;
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

std::size_t read_bytes(int descriptor, char* to, std::size_t count, std::uintmax_t offset) {
  std::error_code error;
  const std::size_t got = read_at(descriptor, to, count, offset, error);
  if (error) throw DataError("cannot read the file: " + error.message());
  return got;
}

/// SHA-256 of all bytes after the user block.
std::string content_hash(int descriptor) {
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  std::uintmax_t offset = user_block_bytes;
  while (const std::size_t got = read_bytes(descriptor, buffer.data(), buffer.size(), offset)) {
    hash.update(buffer.data(), got);
    offset += got;
  }
  return hash.hex();
}

/// The file descriptor that HDF5's own driver uses.
int descriptor_of(const hdf5::Handle& file) {
  void* descriptor = nullptr;
  hdf5::check(H5Fget_vfd_handle(file.id(), H5P_DEFAULT, &descriptor), "find the open file");
  return *static_cast<int*>(descriptor);
}

void require_readable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw ConfigurationError(path.string() + ": no such file");
  if (error) throw DataError(error.message());
  if (fs::is_directory(status)) throw DataError("is a folder, not an archive");
  if (!fs::is_regular_file(status)) throw DataError("is not a regular file");
}

/// Throws an error that says why HDF5 cannot open the file. The reason comes from the first bytes and the hash,
/// otherwise from HDF5.
[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
  std::string bytes(user_block_bytes + hdf5_signature.size(), '\0');
  std::ifstream stream = open_file(path);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  if (bytes.empty()) throw DataError("the file is empty");
  const bool is_ours = bytes.size() > user_block_bytes && is_sha256(bytes.substr(0, hash_bytes));
  if (!is_ours && bytes.substr(0, hdf5_signature.size()) != hdf5_signature &&
      (bytes.size() < user_block_bytes || bytes.substr(user_block_bytes) != hdf5_signature))
    throw DataError("not a modebank archive");
  throw DataError("damaged, or cut off: " + reason);
}

hdf5::Handle open_checked(const fs::path& path) {
  require_readable(path);
  try {
    return hdf5::open_file(path.string());
  } catch (const DataError& error) {
    refuse(path, error.what());
  }
}

/// Returns the hash. Throws DataError if the hash does not match the content.
std::string checked_hash(const hdf5::Handle& file) {
  const int descriptor = descriptor_of(file);
  UserBlock block{};
  read_bytes(descriptor, block.data(), block.size(), 0);
  if (std::string_view(block.data(), hdf5_signature.size()) == hdf5_signature)
    throw DataError("not a modebank archive (an HDF5 file of another program)");
  std::string hash = content_hash(descriptor);
  if (const std::vector<std::string> problems = user_block_problems(block, hash); !problems.empty())
    throw DataError("damaged: " + problems.front());
  return hash;
}

std::string root_text(const hdf5::Handle& root, const std::string& name) {
  if (!hdf5::has_attribute(root.id(), name)) return {};
  const hdf5::StoredArray attribute(root.id(), hdf5::Place::attribute, name);
  return attribute.elements() == 1 ? attribute.texts().front() : std::string();
}

/// The number before the first dot; -1 if the text has no such number.
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
  if (major < major_version(schema_version)) throw DataError("made by an older modebank; run again");
}

}  // namespace

std::string content_hash(const fs::path& path) {
  std::ifstream stream = open_file(path);
  stream.seekg(user_block_bytes);
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || stream.gcount() > 0)
    hash.update(buffer.data(), static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) throw DataError(path.string() + ": cannot be read");
  return hash.hex();
}

struct OpenArchive::File {
  fs::path path;
  hdf5::Handle file;
  std::string digest;

  explicit File(const fs::path& path_of_file) : path(path_of_file) {
    const hdf5::Quiet quiet;
    try {
      file = open_checked(path);
      digest = checked_hash(file);
      check_schema(open_root(file));
    } catch (const DataError& error) {
      file.reset();
      throw DataError(path.string() + ": " + error.what());
    }
  }
  ~File() {
    const hdf5::Quiet quiet;
    file.reset();
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
};

OpenArchive::OpenArchive(const fs::path& path) : file_(std::make_shared<const File>(path)) {}

const fs::path& OpenArchive::path() const { return file_->path; }
const std::string& OpenArchive::digest() const { return file_->digest; }
hdf5::Handle OpenArchive::root() const { return open_root(file_->file); }

hdf5::Handle open_root(const hdf5::Handle& file) { return hdf5::open_group(file.id(), "/"); }

}  // namespace modebank
