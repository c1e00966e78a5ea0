#include "io/archive/load_combination.hpp"

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/layout_evaluation.hpp"
#include "io/hdf5/group_reader.hpp"

namespace modebank {

std::vector<CombinationRow> load_combination(const std::filesystem::path& path) {
  std::vector<CombinationRow> rows;
  read_root(path, [&](GroupReader& root) {
    root.optional_group("evaluation", true, {},
                        [&](GroupReader& member) { layout::exchange_combination(member, rows); });
  });
  return rows;
}

}  // namespace modebank
