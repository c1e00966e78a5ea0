#include "io/archive/load_combination.hpp"

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "io/archive/layout_evaluation.hpp"

namespace modebank {

std::vector<CombinationRow> load_combination(const OpenArchive& archive) {
  std::vector<CombinationRow> rows;
  read_root(archive, [&](GroupReader& root) {
    root.optional_group("evaluation", true, {},
                        [&](GroupReader& member) { layout::exchange_combination(member, rows); });
  });
  return rows;
}

}  // namespace modebank
