// Whole chains on simulated switching systems whose modes are known.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/simulate/simulate.hpp"
#include "mixture/features.hpp"
#include "mixture/select.hpp"
#include "tests/app/chain/recovery_study.hpp"

namespace modebank::test {
namespace {

constexpr int seeds = 50;
constexpr Index window_step = 5;  // a fifth of all windows, so that the tests are short; N_eff hardly changes

/// A system of 2 to 4 well separated modes with R = Q / 25. The seed determines the number of modes.
SimulationOptions system_of(int seed) {
  static const std::vector<Eigen::Vector3d> modes{
      {-0.60, -0.72, 0.72}, {-0.25, -0.20, 0.20}, {-0.45, -0.10, 0.50}, {-0.80, -0.50, 0.15}};
  SimulationOptions options;
  const int count = 2 + seed % 3;
  for (int k = 0; k < count; ++k) options.modes.emplace_back(modes[k]);
  options.process_sd = {0.02};
  options.measurement_sd = 0.004;
  options.input_law = InputLaw::white;
  options.runs = 40;
  options.samples = 500;
  return options;
}

MixtureResult cluster(const Recording& recording, const WindowFits& fits, std::vector<Index> components, int seed) {
  SelectionOptions options;
  options.components = std::move(components);
  const FeatureCloud cloud = make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::automatic,
                                           recording.states, WindowsOverSwitch::leave_out);
  return select_mixture(fits, cloud, options, static_cast<std::uint64_t>(seed));
}

WindowFits fit(const Recording& recording) {
  FitOptions options;
  options.length = window_length;
  options.step = window_step;
  return fit_windows(recording, options);
}

/// For each mode of the bank, the nearest true mode.
std::vector<Index> match(const Bank& bank, const SimulationOptions& system) {
  std::vector<Index> nearest;
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const auto distance = [&](const Eigen::VectorXd& truth) { return (bank.theta(k) - truth).norm(); };
    const auto best = std::min_element(system.modes.begin(), system.modes.end(),
                                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    nearest.push_back(best - system.modes.begin());
  }
  return nearest;
}

bool is_permutation_of_modes(std::vector<Index> matched, std::size_t modes) {
  std::sort(matched.begin(), matched.end());
  std::vector<Index> all(modes);
  std::iota(all.begin(), all.end(), Index{0});
  return matched == all;
}

/// Results for one seed if every run stays in one mode.
struct Stationary {
  bool found_k = false;
  bool matched = false;
  int parameters = 0, within_three_errors = 0;
};

Stationary stationary_seed(int seed) {
  const SimulationOptions system = system_of(seed);
  const auto modes = static_cast<Index>(system.modes.size());
  const Simulated simulated = simulate_recording(system, seed);
  const WindowFits fits = fit(simulated.recording);
  Stationary result;
  const MixtureResult chosen = cluster(simulated.recording, fits, {1, 2, 3, 4, 5, 6}, seed);
  result.found_k = chosen.mixture.components() == modes;
  const MixtureResult at_truth = result.found_k ? chosen : cluster(simulated.recording, fits, {modes}, seed);
  const double R = system.measurement_sd * system.measurement_sd;
  const Bank bank = learn_bank(simulated.recording, fits, at_truth, BankOptions{}, Eigen::MatrixXd::Constant(1, 1, R));
  const std::vector<Index> truth = match(bank, system);
  result.matched = is_permutation_of_modes(truth, system.modes.size());
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::ArrayXd error = (bank.theta(k) - system.modes[truth[i]]).array().abs();
    result.parameters += static_cast<int>(error.size());
    result.within_three_errors += static_cast<int>((error <= 3.0 * bank.modes[i].standard_error.array()).count());
  }
  return result;
}

TEST(Recovery, RunsThatStayInOneMode) {
  std::vector<Stationary> results(seeds);
  tbb::parallel_for(0, seeds, [&](int s) { results[s] = stationary_seed(s + 1); });
  int found = 0, matched = 0, parameters = 0, within = 0;
  for (const Stationary& r : results) {
    found += r.found_k;
    matched += r.matched;
    parameters += r.parameters;
    within += r.within_three_errors;
  }
  fmt::print(
      "BIC found K in {} of {} seeds; modes matched one to one in {}; {} of {} parameters within 3 standard errors\n",
      found, seeds, matched, within, parameters);
  EXPECT_GE(found, 0.8 * seeds);
  EXPECT_EQ(matched, seeds);
  EXPECT_GE(within, 0.97 * parameters);
}

/// Results for one seed if the mode switches within runs. The mean stay is 20 windows.
struct Switching {
  Index overshoot = 0;             // chosen K minus true K
  double worst_theta_error = 0.0;  // relative to the distance between a mode and its nearest neighbour
  double sequence_right = 0.0;
};

double relative_error(const Bank& bank, const SimulationOptions& system, const std::vector<Index>& truth) {
  double worst = 0.0;
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const Eigen::VectorXd& own = system.modes[truth[k]];
    double gap = 1e300;
    for (const Eigen::VectorXd& other : system.modes)
      if (other != own) gap = std::min(gap, (other - own).norm());
    worst = std::max(worst, (bank.theta(k) - own).norm() / gap);
  }
  return worst;
}

double share_of_right_modes(const Bank& bank, const Simulated& simulated, const std::vector<Index>& truth) {
  Index right = 0, all = 0;
  for (std::size_t r = 1; r < simulated.runs.size(); r += 2) {
    const RunEvaluation evaluation = evaluate_run(bank, simulated.recording.runs[r], FilterOptions{});
    for (Index k = 1; k < evaluation.mode_probability.cols(); ++k, ++all) {
      Index best = 0;
      evaluation.mode_probability.col(k).maxCoeff(&best);
      // The mode at k - 1 holds for the transition into sample k.
      right += truth[best] == simulated.runs[r].mode(k - 1);
    }
  }
  return static_cast<double>(right) / static_cast<double>(all);
}

Switching switching_seed(int seed) {
  SimulationOptions system = system_of(seed);
  system.dwell_samples = 20.0 * window_length;
  const auto modes = static_cast<Index>(system.modes.size());
  const Simulated simulated = simulate_recording(system, seed);
  const WindowFits fits = fit(simulated.recording);
  Switching result;
  result.overshoot = cluster(simulated.recording, fits, {1, 2, 3, 4, 5, 6, 7}, seed).mixture.components() - modes;
  const MixtureResult at_truth = cluster(simulated.recording, fits, {modes}, seed);
  const double R = system.measurement_sd * system.measurement_sd;
  const Bank bank = learn_refined_bank(simulated.recording, fits, at_truth, BankOptions{},
                                       Eigen::MatrixXd::Constant(1, 1, R), FilterOptions{})
                        .bank;
  const std::vector<Index> truth = match(bank, system);
  result.worst_theta_error =
      is_permutation_of_modes(truth, system.modes.size()) ? relative_error(bank, system, truth) : 1.0;
  result.sequence_right = share_of_right_modes(bank, simulated, truth);
  return result;
}

TEST(Recovery, SwitchesInsideRuns) {
  constexpr int switching_seeds = 12;
  std::vector<Switching> results(switching_seeds);
  tbb::parallel_for(0, switching_seeds, [&](int s) { results[s] = switching_seed(s + 1); });
  int exact = 0, one_more = 0, more = 0, less = 0;
  for (const Switching& r : results) {
    EXPECT_LE(r.worst_theta_error, 0.03) << "seed " << &r - results.data() + 1;
    EXPECT_GE(r.sequence_right, 0.99) << "seed " << &r - results.data() + 1;
    (r.overshoot < 0 ? less : r.overshoot == 0 ? exact : r.overshoot == 1 ? one_more : more)++;
  }
  fmt::print("with switches BIC finds fewer than K in {}, K in {}, K + 1 in {}, more in {} of {} seeds\n", less, exact,
             one_more, more, switching_seeds);
}

/// Requires that `share` of a few seeds are right. measure_recovery runs all 50 seeds of docs/results/simulated.md.
void expect_recovery(const RecoveryCase& recovery, int few_seeds, double share) {
  const std::vector<RecoveredSize> sizes = recover_sizes(recovery, few_seeds);
  fmt::print("{}: {} of {}, naive BIC {}\n", recovery.name, right(sizes, &RecoveredSize::chosen), few_seeds,
             right(sizes, &RecoveredSize::naive));
  EXPECT_GE(right(sizes, &RecoveredSize::chosen), share * few_seeds) << recovery.name;
}

TEST(Recovery, NumberOfModes) {
  RecoveryCase recovery{.name = "runs in one mode, step 1"};
  expect_recovery(recovery, 5, 0.8);
  recovery.name = "runs in one mode, step L";
  recovery.step = window_length;
  expect_recovery(recovery, 10, 0.8);
  recovery = {.name = "switches every 20 L, noise component", .dwell_windows = 20.0, .step = window_step};
  recovery.noise_component = true;
  expect_recovery(recovery, 10, 0.7);
  recovery.name = "the same with held inputs";
  recovery.hold_samples = 5;
  expect_recovery(recovery, 10, 0.7);
}

}  // namespace
}  // namespace modebank::test
