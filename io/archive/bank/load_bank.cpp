#include "io/archive/bank/load_bank.hpp"

#include <functional>
#include <optional>
#include <stdexcept>

#include "io/archive/bank/layout_drifting.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

void read_root(const OpenArchive& archive, const std::function<void(GroupReader&)>& body) {
  const hdf5::Quiet quiet;
  try {
    GroupReader root(archive.root(), nullptr);
    body(root);
  } catch (const DataError& error) {
    throw DataError(archive.path().string() + ": " + error.what());
  }
}

Bank load_bank(const OpenArchive& archive, const std::string& which) {
  std::optional<Bank> bank;
  read_root(archive, [&](GroupReader& root) {
    layout::exchange_part(root, which, bank, {}, [&](GroupReader& member, Bank& part) {
      if (which == "drifting")
        layout::exchange_drifting(member, part, Units(Recording()));
      else
        layout::exchange_bank(member, part, Units(Recording()));
    });
    if (!bank && which == "nonlinear")
      throw DataError(
          "has no filter nonlinear, because terms gained nothing on its training runs or window.terms was none; its "
          "filters are bank, baseline, noise_only, one_motion, drifting and combined");
    if (!bank) throw DataError("holds no " + which);
  });
  return *bank;
}

std::string load_configuration(const OpenArchive& archive) {
  std::string text;
  read_root(archive, [&](GroupReader& root) { root.text("config", text); });
  return text;
}

std::string load_data_hash(const OpenArchive& archive) {
  std::string hash;
  read_root(archive, [&](GroupReader& root) { root.attribute("data_hash", hash); });
  return hash;
}

}  // namespace modebank
