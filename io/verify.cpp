#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

#include "ident/error.hpp"
#include "io/archive.hpp"
#include "io/archive_file.hpp"
#include "io/read_stages.hpp"
#include "io/sha256.hpp"
#include "io/user_block.hpp"

namespace modebank {

namespace {

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

}  // namespace

Verification verify_archive(const std::filesystem::path& path) {
  require_readable(path);
  const hdf5::Quiet quiet;
  Verification verification{hash_problems(path)};
  try {
    const hdf5::Handle file = open_archive(path);
    std::vector<std::string> found;
    read_stages(file, &found);
    verification.problems.insert(verification.problems.end(), found.begin(), found.end());
  } catch (const DataError& error) {
    verification.problems.emplace_back(error.what());
  }
  return verification;
}

}  // namespace modebank
