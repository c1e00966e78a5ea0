#include "io/archive/bank/open_archive.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <system_error>

#include "io/files/sha256.hpp"
#include "io/hdf5/array.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr std::size_t hash_bytes = 64;

bool is_lowercase_hex(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

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
  if (!std::all_of(stored.begin(), stored.end(), is_lowercase_hex))
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

/// Of everything from where `file` stands to its end.
std::string hash_of_rest(std::ifstream& file) {
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), file.gcount() > 0)
    hash.update(buffer.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) throw DataError("cannot read the file: " + std::generic_category().message(errno));
  return hash.hex();
}

}  // namespace

std::string content_hash(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(user_block_bytes));
  return hash_of_rest(file);
}

std::vector<std::string> hash_problems(const std::filesystem::path& path) try {
  std::ifstream file(path, std::ios::binary);
  if (!file) return {"cannot open the file: " + std::generic_category().message(errno)};
  UserBlock block{};
  if (!file.read(block.data(), block.size())) return {"the file is shorter than its user block"};
  return user_block_problems(block, hash_of_rest(file));
} catch (const DataError& error) {
  return {error.what()};
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

std::string bytes_at(const fs::path& path, std::streamoff offset, std::size_t count) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(std::generic_category().message(errno));
  std::string bytes(count, '\0');
  file.seekg(offset);
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// Where HDF5's superblock, which the signature begins, says that the file ends; 0 where it is not one that we write.
std::uintmax_t stated_end(const fs::path& path) {
  constexpr std::size_t version_at = 8, address_size_at = 9, end_at = 28, address_bytes = 8;
  const std::string superblock = bytes_at(path, user_block_bytes, end_at + address_bytes);
  if (superblock.size() < end_at + address_bytes || superblock[version_at] != 2 ||
      superblock[address_size_at] != address_bytes)
    return 0;
  std::uintmax_t end = 0;
  for (std::size_t i = address_bytes; i-- > 0;) end = end << 8 | static_cast<unsigned char>(superblock[end_at + i]);
  return end;
}

/// Before HDF5 sees the file: most foreign files are told apart here, and those that were cut off.
void check_signature(const fs::path& path) {
  const std::uintmax_t bytes = fs::file_size(path);
  if (bytes == 0) throw DataError("the file is empty");
  if (bytes_at(path, user_block_bytes, hdf5_signature.size()) == hdf5_signature) {
    if (const std::uintmax_t end = stated_end(path); bytes < end)
      throw DataError("truncated file: " + std::to_string(bytes) + " of " + std::to_string(end) + " bytes are there");
    return;
  }
  if (bytes_at(path, 0, hdf5_signature.size()) == hdf5_signature)
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

void check_hash(const fs::path& path) {
  if (const std::vector<std::string> problems = hash_problems(path); !problems.empty())
    throw DataError("damaged: " + problems.front());
}

}  // namespace

void require_readable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw ConfigurationError(path.string() + ": no such file");
  if (fs::is_directory(status)) throw DataError(path.string() + ": is a folder, not an archive");
  if (!fs::is_regular_file(status)) throw DataError(path.string() + ": is not a regular file");
}

hdf5::Handle open_archive(const fs::path& path, HashCheck hash) {
  require_readable(path);
  try {
    check_signature(path);
    if (hash == HashCheck::before) check_hash(path);
    hdf5::Handle file = hdf5::open_file(path.string());
    check_schema(open_root(file));
    return file;
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  } catch (const fs::filesystem_error& error) {
    throw DataError(path.string() + ": " + error.code().message());
  }
}

hdf5::Handle open_root(const hdf5::Handle& file) { return hdf5::open_group(file.id(), "/"); }

}  // namespace modebank
