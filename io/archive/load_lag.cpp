#include "io/archive/load_lag.hpp"

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "io/archive/layout_data.hpp"

namespace modebank {

std::optional<LagReport> load_lag(const OpenArchive& archive) {
  std::optional<LagReport> lag;
  read_root(archive, [&](GroupReader& root) {
    root.optional_group("lag", true, {}, [&](GroupReader& member) { layout::exchange_lag(member, lag.emplace()); });
  });
  return lag;
}

}  // namespace modebank
