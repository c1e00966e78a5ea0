#include "io/files/input_file.hpp"

#include "ident/base/printable.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

InputFile describe_file(const std::filesystem::path& path) {
  constexpr std::size_t block_bytes = 1 << 18;
  std::ifstream stream = open_file(path);
  stream.rdbuf()->pubsetbuf(nullptr, 0);
  std::vector<char> block(block_bytes);
  InputFile file{printable_name(std::filesystem::absolute(path).string()), 0, {}};
  Sha256 hash;
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.update(block.data(), static_cast<std::size_t>(stream.gcount()));
    file.bytes += static_cast<std::uint64_t>(stream.gcount());
  }
  if (stream.bad()) throw ConfigurationError("cannot read " + path.string());
  file.sha256 = hash.hex();
  return file;
}

std::string data_hash(const std::vector<InputFile>& files) {
  Sha256 hash;
  for (const InputFile& file : files) hash.update(file.sha256);
  return hash.hex();
}

}  // namespace modebank
