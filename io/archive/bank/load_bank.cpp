#include "io/load_bank.hpp"

#include <fstream>
#include <optional>

#include "ident/error.hpp"
#include "io/archive_file.hpp"
#include "io/archive_layout.hpp"
#include "io/archive_reader.hpp"
#include "io/user_block.hpp"

namespace modebank {

namespace {

/// Runs `body` on the root of a whole archive; messages name the path.
template <class Body>
void read_root(const std::filesystem::path& path, Body body) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(path);
  if (const std::vector<std::string> problems = hash_problems(path); !problems.empty())
    throw DataError(path.string() + ": damaged: " + problems.front());
  try {
    ArchiveReader root(open_root(file), nullptr);
    body(root);
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

}  // namespace

Bank load_bank(const std::filesystem::path& path, const std::string& which) {
  std::optional<Bank> bank;
  read_root(path, [&](ArchiveReader& root) {
    layout::exchange_part(root, which, bank, {}, [](ArchiveReader& member, Bank& part) {
      layout::exchange_bank(member, part, Units(Recording()));
    });
    if (!bank) throw DataError("holds no " + which);
  });
  return *bank;
}

std::string load_configuration(const std::filesystem::path& path) {
  std::string text;
  read_root(path, [&](ArchiveReader& root) { root.text("config", text); });
  return text;
}

std::string archive_digest(const std::filesystem::path& path) {
  constexpr std::size_t hex_digits = 64;
  std::string digest(hex_digits, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(digest.data(), hex_digits);
  if (!file) throw DataError(path.string() + ": cannot be read");
  return digest;
}

}  // namespace modebank
