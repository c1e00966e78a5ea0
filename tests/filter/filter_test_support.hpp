#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "filter/judge/diagnostics.hpp"
#include "ident/data/public_recording.hpp"
#include "tests/filter/public_bank.hpp"

namespace modebank::test {

inline Bank example_bank(Index n, Index m, Index K, double r = 1e-4) {
  return filter::Bank(example_description(n, m, K, r)).internal();
}

/// A run of the bank with its true states and modes.
struct SimulatedTruth {
  Trajectory run;
  Eigen::VectorXi mode;
};

inline SimulatedTruth simulate_truth(const Bank& bank, Index samples, std::uint64_t seed) {
  const filter::Bank copy(std::make_shared<const Bank>(bank));
  const SimulatedRun made = simulate_description(copy.description(), samples, seed);
  SimulatedTruth result{to_trajectory(made.run, bank.C.rows(), bank.structure.inputs), made.mode};
  result.run.truth = made.truth;
  return result;
}

/// The run without its true states.
inline Trajectory simulate_bank(const Bank& bank, Index samples, std::uint64_t seed) {
  Trajectory run = simulate_truth(bank, samples, seed).run;
  run.truth.resize(0, 0);
  return run;
}

/// The bank with only mode `j`.
inline Bank single_mode(Bank bank, std::size_t j) {
  bank.modes = {bank.modes[j]};
  bank.transition = TransitionMatrix();
  bank.initial_probability = Eigen::VectorXd::Ones(1);
  return bank;
}

/// The part of the bank that this variant can filter. For kf it is the first mode only.
inline Bank steppable(Bank bank, FilterVariant variant) {
  return variant == FilterVariant::kf ? single_mode(std::move(bank), 0) : bank;
}

inline std::vector<RunScores> score_runs(const std::vector<RunEvaluation>& evaluations) {
  std::vector<RunScores> scores;
  for (const RunEvaluation& evaluation : evaluations) scores.push_back(score_run(evaluation));
  return scores;
}

/// The rows of a filter on unseen runs.
inline std::vector<DiagnosticsRow> diagnose_runs(const Bank& bank, std::vector<Trajectory> runs,
                                                 const FilterOptions& options = {}) {
  std::vector<RunEvaluation> evaluations;
  for (Trajectory& run : runs) {
    run.role = Role::test;
    evaluations.push_back(evaluate_run(bank, run, options));
    evaluations.back().viterbi_mode = mode_sequence(bank, run, options);
  }
  return diagnose("bank", Role::test, bank, bank.mode_count() == 1, runs, evaluations, score_runs(evaluations));
}

/// The row of the whole filter.
inline DiagnosticsRow row_of(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& options = {}) {
  return diagnose_runs(bank, runs, options).front();
}

/// The row of a filter on signals with these scores. `nis`: factor on the NIS.
inline DiagnosticsRow row_of(const std::vector<std::vector<double>>& scores, bool chi_square_nis = false,
                             double nis = 1.0) {
  const Index signals = std::ssize(scores), samples = std::ssize(scores[0]) + 1;
  const Bank bank = single_mode(example_bank(signals, 0, 1, 1e-6), 0);
  Trajectory run;
  run.state.setZero(signals, samples);
  run.input.setZero(0, samples);
  RunEvaluation e = evaluate_run(bank, run, {});
  e.nis.tail(samples - 1).setZero();
  for (Index i = 0; i < signals; ++i)
    for (Index k = 1; k < samples; ++k) {
      const double z = scores[i][k - 1];
      e.pit(i, k) = 0.5 * std::erfc(-z / std::sqrt(2.0));
      e.nis(k) += nis * z * z;
    }
  run.role = Role::test;
  return diagnose("bank", Role::test, bank, chi_square_nis, {run}, {e}, score_runs({e})).front();
}

}  // namespace modebank::test
