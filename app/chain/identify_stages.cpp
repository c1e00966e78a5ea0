#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/chain/stages.hpp"
#include "app/config/section.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

bool streams_windows(const Recording& recording, const WindowInputs& inputs) {
  constexpr Index in_memory = 1000000;  // largest number of windows in memory: about 150 MB for a model with three
                                        // parameters
  return count_windows(recording, inputs.window) > in_memory;
}

WindowFits identify_into_file(const std::filesystem::path& path, const Archive& before, const WindowInputs& inputs,
                              const std::function<void(const WindowFits&)>& report) {
  const Recording& recording = *before.recording;
  const auto produce = [&](const WindowSink& sink) {
    const WindowSink report_and_sink = [&](const WindowFits& fits, Index first) {
      report(fits);
      sink(fits, first);
    };
    return in_section("window", [&] { return stream_windows(recording, inputs.window, report_and_sink); });
  };
  return write_archive(path, before, count_windows(recording, inputs.window), produce);
}

}  // namespace modebank
