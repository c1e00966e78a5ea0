#include "io/archive/load_lag.hpp"

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/layout_data.hpp"
#include "io/hdf5/group_reader.hpp"

namespace modebank {

std::optional<LagReport> load_lag(const std::filesystem::path& path) {
  std::optional<LagReport> lag;
  read_root(path, [&](GroupReader& root) {
    root.optional_group("lag", true, {}, [&](GroupReader& member) { layout::exchange_lag(member, lag.emplace()); });
  });
  return lag;
}

}  // namespace modebank
