// libFuzzer's functions for the reader that MODEBANK_FUZZ names. Without libFuzzer, a main function that runs every
// corpus.
#include "tests/fuzz/entry.hpp"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

// LeakSanitizer must ignore TBB, because TBB's threads run until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libtbb\n"; }  // NOLINT

namespace modebank::fuzz {

namespace {

std::map<std::string, void (*)(std::string_view)>& entries() {
  static std::map<std::string, void (*)(std::string_view)> all;
  return all;
}

void run(void (*read)(std::string_view), std::string_view input) {
  try {
    read(input);
  } catch (const ConfigurationError&) {
  } catch (const DataError&) {
  }
}

}  // namespace

Entry::Entry(const char* name, void (*read)(std::string_view)) { entries()[name] = read; }

std::filesystem::path scratch_file(std::string_view name, std::string_view content) {
  static const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  return path;
}

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

}  // namespace modebank::fuzz

using namespace modebank;  // NOLINT

#ifdef MODEBANK_LIBFUZZER

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {  // NOLINT
  const char* name = std::getenv("MODEBANK_FUZZ");
  static const auto read = fuzz::entries().at(name == nullptr ? "" : name);
  fuzz::run(read, {reinterpret_cast<const char*>(data), size});
  return 0;
}

#else

/// fuzz [NAME FILE...]: runs all corpora, or the reader NAME on these files.
int main(int argc, char** argv) {
  const auto run_file = [](const std::string& name, const std::filesystem::path& path) {
    std::printf("%s %s\n", name.c_str(), path.c_str());
    std::fflush(stdout);
    std::ifstream file(path, std::ios::binary);
    fuzz::run(fuzz::entries().at(name), std::string(std::istreambuf_iterator<char>(file), {}));
  };
  for (int i = 2; i < argc; ++i) run_file(argv[1], argv[i]);
  if (argc > 1) return 0;
  for (const auto& [name, read] : fuzz::entries())
    for (const auto& file :
         std::filesystem::directory_iterator(test::project_dir() / "tests" / "fuzz" / "corpus" / name))
      run_file(name, file.path());
}

#endif
