#include "tests/support/paths.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace modebank::test {

std::filesystem::path project_dir() { return MODEBANK_SOURCE_DIR; }

std::filesystem::path golden_dir() { return project_dir() / "tests" / "golden" / "data"; }

namespace {

std::filesystem::path find_shared_data() {
  const char* configured = std::getenv("MODEBANK_DATA");
  const std::filesystem::path folder = configured && *configured
                                           ? std::filesystem::path(configured)
                                           : std::filesystem::path(MODEBANK_SOURCE_DIR) / ".." / "shared" / "data";
  return std::filesystem::exists(folder / "borealtc" / "ICE") ? std::filesystem::canonical(folder)
                                                              : std::filesystem::path();
}

}  // namespace

std::filesystem::path shared_data_dir() {
  static const std::filesystem::path found = find_shared_data();
  return found;
}

/// Found before main runs, because CliTest hides MODEBANK_DATA from the program, and so from this process.
[[maybe_unused]] const std::filesystem::path looked_up = shared_data_dir();

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

bool is_ci() {
  const char* const value = std::getenv("CI");
  return value && std::string(value) == "true";
}

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

bool has_python_modules(const std::string& names) {
  return std::system(("/usr/bin/python3 -c 'import " + names + "' >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace modebank::test
