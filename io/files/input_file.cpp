#include "io/files/input_file.hpp"

#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"

namespace modebank {

InputFile describe_file(const std::filesystem::path& path) {
  const std::string content = read_file(path);
  return {std::filesystem::absolute(path).string(), content.size(), sha256_hex(content)};
}

std::string data_hash(const std::vector<InputFile>& files) {
  Sha256 hash;
  for (const InputFile& file : files) hash.update(file.sha256);
  return hash.hex();
}

}  // namespace modebank
