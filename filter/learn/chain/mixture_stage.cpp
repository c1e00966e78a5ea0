#include <fmt/format.h>

#include "filter/learn/chain/stages.hpp"
#include "filter/learn/from_mixture/cluster_windows.hpp"

namespace modebank {

MixtureResult cluster(const Recording& recording, const WindowFits& windows, const MixtureInputs& inputs,
                      const Progress& progress) {
  const Stopwatch watch;
  MixtureResult result = cluster_windows(recording, windows, inputs.window, inputs.mixture, inputs.seed);
  const std::string part =
      result.compared > 0 ? ", candidates compared on " + of_all(result.compared, result.clustered) + "," : "";
  progress.progress(fmt::format("mixture: {} components from {} windows{} in {:.2f} s", result.mixture.components(),
                                result.clustered, part, watch.seconds()));
  return result;
}

}  // namespace modebank
