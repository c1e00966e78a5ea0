#include <benchmark/benchmark.h>

#include <cmath>

#include "filter/judge/run/evaluate.hpp"
#include "tests/bench/bench_bank.hpp"
#include "tests/bench/bench_data.hpp"

namespace modebank {
namespace {

/// Log likelihood of one run. Argument: K. Items are steps.
void imm_steps(benchmark::State& state) {
  const Recording recording = bench::make_recording(1, 20000);
  const Bank bank = bench::make_bank(state.range(0));
  const Eigen::VectorXd scores = evaluate_run(bank, recording.runs[0], FilterOptions{}).log_density;
  const double expected = scores.tail(scores.size() - 1).sum();  // the first sample has no score
  constexpr double rounding = 1e-9;
  for (auto _ : state) {
    const double value = log_likelihood(bank, recording.runs[0], FilterOptions{});
    bench::check(std::abs(value - expected) <= rounding * std::abs(expected), "log likelihood");
    benchmark::DoNotOptimize(value);
  }
  state.SetItemsProcessed(state.iterations() * recording.runs[0].transitions());
}
BENCHMARK(imm_steps)->Arg(1)->Arg(3)->Arg(9)->Arg(25)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace modebank
