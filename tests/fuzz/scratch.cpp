#include "tests/fuzz/scratch.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace modebank::fuzz {

namespace {

std::filesystem::path& folder() {
  static std::filesystem::path path;
  return path;
}

}  // namespace

void set_scratch_folder(const std::filesystem::path& path) { folder() = path; }

std::filesystem::path scratch(std::string_view name) { return folder() / name; }

std::filesystem::path scratch_file(std::string_view name, std::string_view content) {
  const std::filesystem::path path = scratch(name);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
  return path;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace modebank::fuzz
