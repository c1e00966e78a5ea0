#include <benchmark/benchmark.h>

#include <cmath>

#include "filter/evaluate.hpp"
#include "tests/bench/bench_data.hpp"

namespace modebank {
namespace {

/// K modes spread around the simulated ones.
Bank make_bank(Eigen::Index modes) {
  Bank bank;
  bank.structure = {1, 2, false};
  for (Eigen::Index k = 0; k < modes; ++k) {
    const double t = static_cast<double>(k + 1) / static_cast<double>(modes);
    Mode mode;
    mode.model = {Eigen::MatrixXd::Constant(1, 1, -0.6 * t), Eigen::RowVector2d(-0.7 * t, 0.7 * t),
                  Eigen::VectorXd::Zero(1)};
    mode.Q = Eigen::MatrixXd::Constant(1, 1, 4e-4 * t);
    mode.spread = Eigen::MatrixXd::Zero(3, 3);
    mode.standard_error = Eigen::VectorXd::Zero(3);
    mode.weight = 1.0 / static_cast<double>(modes);
    bank.modes.push_back(mode);
  }
  bank.C = Eigen::MatrixXd::Identity(1, 1);
  bank.R = Eigen::MatrixXd::Constant(1, 1, 1e-6);
  bank.transition = TransitionMatrix::sticky(modes, 0.95);
  bank.initial_probability = Eigen::VectorXd::Constant(modes, 1.0 / static_cast<double>(modes));
  return bank;
}

/// Log likelihood of one run; argument: K. Items are steps.
void imm_steps(benchmark::State& state) {
  const Recording recording = bench::make_recording(1, 20000);
  const Bank bank = make_bank(state.range(0));
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
