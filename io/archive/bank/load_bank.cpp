#include "io/archive/bank/load_bank.hpp"

#include <fstream>
#include <functional>
#include <optional>
#include <stdexcept>

#include "io/archive/bank/layout_drifting.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/hdf5/group_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

void read_root(const std::filesystem::path& path, const std::function<void(GroupReader&)>& body) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(path, HashCheck::before);
  try {
    GroupReader root(open_root(file), nullptr);
    body(root);
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

Bank load_bank(const std::filesystem::path& path, const std::string& which) {
  std::optional<Bank> bank;
  read_root(path, [&](GroupReader& root) {
    layout::exchange_part(root, which, bank, {}, [](GroupReader& member, Bank& part) {
      layout::exchange_bank(member, part, Units(Recording()));
    });
    if (!bank && which == "nonlinear")
      throw DataError(
          "holds no nonlinear, as its training runs asked for no terms or window.terms = none; its filters are bank, "
          "baseline, noise_only, one_motion, drifting and combined");
    if (!bank) throw DataError("holds no " + which);
  });
  return *bank;
}

DriftingModel load_drifting(const std::filesystem::path& path) {
  std::optional<DriftingModel> model;
  read_root(path, [&](GroupReader& root) {
    layout::exchange_part(root, "drifting", model, {}, [](GroupReader& member, DriftingModel& part) {
      layout::exchange_drifting(member, part, Units(Recording()));
    });
    if (!model) throw DataError("holds no drifting");
  });
  return *model;
}

std::string load_configuration(const std::filesystem::path& path) {
  std::string text;
  read_root(path, [&](GroupReader& root) { root.text("config", text); });
  return text;
}

std::string load_data_hash(const std::filesystem::path& path) {
  std::string hash;
  read_root(path, [&](GroupReader& root) { root.attribute("data_hash", hash); });
  return hash;
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
