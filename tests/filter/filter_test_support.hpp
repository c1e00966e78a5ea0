#pragma once

#include <memory>
#include <utility>

#include "filter/step/bank.hpp"
#include "ident/data/public_recording.hpp"
#include "tests/filter/public_bank.hpp"

namespace modebank::test {

inline Bank example_bank(Eigen::Index n, Eigen::Index m, Eigen::Index K, double r = 1e-4) {
  return filter::Bank(example_description(n, m, K, r)).internal();
}

/// A run of the bank with its true states and modes.
struct SimulatedTruth {
  Trajectory run;
  Eigen::VectorXi mode;
};

inline SimulatedTruth simulate_truth(const Bank& bank, Eigen::Index samples, std::uint64_t seed) {
  const filter::Bank copy(std::make_shared<const Bank>(bank));
  const SimulatedRun made = simulate_description(copy.description(), samples, seed);
  SimulatedTruth result{to_trajectory(made.run, bank.C.rows(), bank.structure.inputs), made.mode};
  result.run.truth = made.truth;
  return result;
}

/// The run without its true states.
inline Trajectory simulate_bank(const Bank& bank, Eigen::Index samples, std::uint64_t seed) {
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

}  // namespace modebank::test
