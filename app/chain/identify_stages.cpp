#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "app/chain/judged_runs.hpp"
#include "app/chain/section.hpp"
#include "app/chain/stages.hpp"
#include "filter/learn/from_mixture/cluster_windows.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

bool streams_windows(const Recording& recording, const WindowInputs& inputs) {
  constexpr Index in_memory = 1000000;  // some 150 MB for three parameters
  return count_windows(recording, inputs.window) > in_memory;
}

WindowFits identify_into_file(const std::filesystem::path& path, const Archive& before, const WindowInputs& inputs,
                              const std::function<void(const WindowFits&)>& hears) {
  const Recording& recording = *before.recording;
  const auto produce = [&](const WindowSink& sink) {
    const WindowSink hears_and_sinks = [&](const WindowFits& fits, Index first) {
      hears(fits);
      sink(fits, first);
    };
    return in_section("window", [&] { return stream_windows(recording, inputs.window, hears_and_sinks); });
  };
  return write_archive(path, before, count_windows(recording, inputs.window), produce);
}

WindowFits identify(const Recording& recording, const WindowInputs& inputs) {
  return in_section("window", [&] { return fit_windows(recording, inputs.window); });
}

namespace {

/// The mixture of another archive, which must be over the same features.
GaussianMixture stored_start(const MixtureInputs& inputs, const std::vector<std::string>& features,
                             const Listener& listener) {
  const std::string& file = inputs.start_file;
  Archive stored = read_archive(file);
  if (!stored.mixture) throw DataError(fmt::format("{} holds no mixture to start from", file));
  if (stored.mixture->feature_names != features)
    throw DataError(fmt::format("the mixture of {} to start from is over {}, this one over {}", file,
                                fmt::join(stored.mixture->feature_names, ", "), fmt::join(features, ", ")));
  const std::vector<Index>& sizes = inputs.mixture.selection.components;
  const Index components = stored.mixture->mixture.components();
  if (std::find(sizes.begin(), sizes.end(), components) == sizes.end())
    listener.warning(fmt::format("the mixture of {} to start from has {} components, which is not among the candidates",
                                 file, components));
  return std::move(stored.mixture->mixture);
}

}  // namespace

MixtureResult cluster(const Recording& recording, const WindowFits& windows, const MixtureInputs& inputs,
                      const Listener& listener) {
  const Stopwatch watch;
  const auto start = [&](const FeatureCloud& cloud) -> std::optional<GaussianMixture> {
    if (inputs.start_file.empty()) return std::nullopt;
    return stored_start(inputs, cloud.names, listener);
  };
  MixtureResult result = cluster_windows(recording, windows, inputs.window, inputs.mixture, inputs.seed, start);
  const std::string part =
      result.compared > 0 ? ", candidates compared on " + of_all(result.compared, result.clustered) + "," : "";
  listener.progress(fmt::format("mixture: {} components from {} windows{} in {:.2f} s", result.mixture.components(),
                                result.clustered, part, watch.seconds()));
  return result;
}

}  // namespace modebank
