#include <fmt/format.h>

#include "app/chain/drifting_structure.hpp"
#include "app/chain/stages.hpp"
#include "ident/lag/structure_search.hpp"

namespace modebank {

FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Listener& listener) {
  const Stopwatch watch;
  FoundStructure found = find_structure(recording, inputs.window, inputs.searched);
  let_drifting_choose(recording, inputs, found);
  listener.progress(fmt::format("structure: {} structures compared in {:.2f} s", found.structures, watch.seconds()));
  if (!found.remark.empty()) listener.warning("structure: " + found.remark);
  return found;
}

ChainOptions with_structure(ChainOptions options, const FoundStructure& found) {
  FitOptions& window = options.window;
  window.state_lags = found.state_lags;
  window.input_lags = found.input_lags;
  window.input_delay = found.input_delay;
  if (has_lags(window)) window.model = "varx";
  return options;
}

}  // namespace modebank
