#include <benchmark/benchmark.h>

#include "ident/fit/fit_windows.hpp"
#include "tests/bench/bench_data.hpp"

namespace modebank {
namespace {

/// Windows of 25 transitions and 3 parameters, fitted with the default options. Argument: the loss.
void fit_windows_of_loss(benchmark::State& state) {
  const Recording recording = bench::make_recording(4, 800);
  FitOptions options;
  options.loss = static_cast<Loss>(state.range(0));
  Index windows = 0;
  for (auto _ : state) {
    const WindowFits fits = fit_windows(recording, options);
    windows += fits.count();
    bench::check((fits.status.array() == static_cast<int>(FitStatus::converged)).all(), "a window did not converge");
    benchmark::DoNotOptimize(fits.parameters.data());
  }
  state.SetItemsProcessed(windows);
  state.SetLabel(std::string(name_of(options.loss)));
}
BENCHMARK(fit_windows_of_loss)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace modebank
