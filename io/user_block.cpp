#include "io/user_block.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

#include "ident/error.hpp"
#include "io/sha256.hpp"

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
    problems.push_back("the user block holds no SHA-256 in bytes 0-63");
  else if (stored != content_sha256)
    problems.push_back("the content's SHA-256 is " + std::string(content_sha256) + ", the user block says " +
                       std::string(stored) + ": the file was damaged or changed after it was written");
  const auto odd = std::find_if(block.begin() + hash_bytes, block.end(), [](char c) { return c != '\0'; });
  if (odd != block.end())
    problems.push_back("byte " + std::to_string(odd - block.begin()) + " of the user block is not zero");
  return problems;
}

std::string content_hash(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(user_block_bytes));
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), file.gcount() > 0)
    hash.update(buffer.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) throw DataError("cannot read the file: " + std::generic_category().message(errno));
  return hash.hex();
}

std::vector<std::string> hash_problems(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return {"cannot open the file: " + std::generic_category().message(errno)};
  UserBlock block{};
  if (!file.read(block.data(), block.size())) return {"the file is shorter than its user block"};
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), file.gcount() > 0)
    hash.update(buffer.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) return {"cannot read the file: " + std::generic_category().message(errno)};
  return user_block_problems(block, hash.hex());
}

}  // namespace modebank
