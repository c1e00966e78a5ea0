#include <fmt/format.h>

#include "filter/learn/chain/stage_structures.hpp"
#include "filter/learn/chain/stages.hpp"
#include "ident/lag/structure_search.hpp"

namespace modebank {

FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Progress& progress) {
  const Stopwatch watch;
  FoundStructure found = find_structure(recording, inputs.window, inputs.searched);
  choose_for_stages(recording, inputs, found);
  progress.progress(fmt::format("structure: {} structures compared in {:.2f} s", found.structures, watch.seconds()));
  if (!found.remark.empty()) progress.warning("structure: " + found.remark);
  return found;
}

LearningOptions with_structure(const LearningOptions& of, const FoundStructure& found) {
  LearningOptions options = of;
  FitOptions& window = options.window;
  window.state_lags = found.state_lags;
  window.input_lags = found.input_lags;
  window.input_delay = found.input_delay;
  if (has_lags(window)) window.model = "varx";
  for (const StructureScore& s : found.scores) {
    const Lags lags{s.state_lags, s.input_lags, s.input_delay};
    if (s.linear) options.other_lags.linear = lags;
    if (s.one_motion) options.other_lags.one_motion = lags;
    if (s.drifting) options.other_lags.drifting = lags;
  }
  return options;
}

}  // namespace modebank
