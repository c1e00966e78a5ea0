#include "tests/support/paths.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace modebank::test {

std::filesystem::path project_dir() { return MODEBANK_SOURCE_DIR; }

std::filesystem::path golden_dir() { return project_dir() / "tests" / "golden" / "data"; }

std::filesystem::path shared_data_dir() {
  const char* configured = std::getenv("MODEBANK_DATA");
  const std::filesystem::path folder = configured && *configured
                                           ? std::filesystem::path(configured)
                                           : std::filesystem::path(MODEBANK_SOURCE_DIR) / ".." / "shared" / "data";
  return std::filesystem::exists(folder / "borealtc" / "ICE") ? std::filesystem::canonical(folder)
                                                              : std::filesystem::path();
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "modebank_test_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary folder " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void write_file(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

}  // namespace modebank::test
