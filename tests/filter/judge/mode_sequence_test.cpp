// The most probable sequence of modes.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "filter/step/samples.hpp"
#include "ident/data/stretch.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::example_bank;
using test::simulate_bank;

/// The sequence of modes with the highest joint density, of all sequences, for exactly measured states.
Eigen::VectorXi best_of_all(const Bank& bank, const Trajectory& run) {
  const int K = static_cast<int>(bank.mode_count()), samples = static_cast<int>(run.samples());
  double best = -1e300;
  Eigen::VectorXi result(samples);
  for (int code = 0; code < std::pow(K, samples); ++code) {
    Eigen::VectorXi s(samples);
    for (int k = 0, rest = code; k < samples; ++k, rest /= K) s(k) = rest % K;
    double value = std::log(bank.initial_probability(s(0)));
    for (Index k = 1; k < samples; ++k) {
      const Mode& mode = bank.modes[s(k)];
      const double e = run.state(0, k) - mode.model.next(run.state.col(k - 1), run.input.col(k - 1))(0);
      const double Q = mode.Q(0, 0);
      value += std::log(bank.transition.matrix()(s(k - 1), s(k))) - 0.5 * (std::log(Q) + e * e / Q);
    }
    if (value > best) {
      best = value;
      result = s;
    }
  }
  return result;
}

Bank exact_bank(Index modes, double stay) {
  Bank bank = example_bank(1, 1, modes, 0.0);
  bank.transition = TransitionMatrix::sticky(modes, stay);
  bank.initial_probability = Eigen::VectorXd::LinSpaced(modes, 1.0, 2.0);
  bank.initial_probability /= bank.initial_probability.sum();
  return bank;
}

TEST(ModeSequence, IsTheBestOfAllSequencesWhenTheStateIsMeasuredExactly) {
  for (const std::uint64_t seed : {24, 25, 26}) {
    const Bank two = exact_bank(2, 0.7), three = exact_bank(3, 0.6);
    const Trajectory long_run = simulate_bank(two, 12, seed), run = simulate_bank(three, 8, seed);
    for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
      EXPECT_EQ(mode_sequence(two, long_run, {variant}), best_of_all(two, long_run)) << name_of(variant);
      EXPECT_EQ(mode_sequence(three, run, {variant}), best_of_all(three, run)) << name_of(variant);
    }
  }
}

TEST(ModeSequence, BeginsAnewWhereTheFilterStartsAnew) {
  Bank bank = example_bank(1, 1, 2);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 30, 22);
  run.time_s.tail(18).array() += 2 * longest_gap_steps;
  EXPECT_EQ(mode_sequence(bank, run, {}).head(12), mode_sequence(bank, stretch(run, 0, 12), {}));
  run.state(0, 0) = std::nan("");  // the filter starts at the next sample
  Eigen::VectorXi of_one_mode = Eigen::VectorXi::Zero(30);
  of_one_mode(0) = -1;
  EXPECT_EQ(mode_sequence(test::single_mode(bank, 0), run, {}), of_one_mode);
}

TEST(ModeSequence, EndsInAModeWhereNoiseIsSingularAndASampleIsFarOff) {
  Bank bank = example_bank(2, 1, 3);
  for (Mode& mode : bank.modes) mode.Q = Eigen::MatrixXd::Constant(2, 2, 1e-4);
  Trajectory run = simulate_bank(bank, 60, 23);
  run.state.col(20).setConstant(1e6);
  for (const double R : {1e-4, 1e-12, 0.0}) {
    bank.R = R * Eigen::Matrix2d::Identity();
    const Eigen::VectorXi modes = mode_sequence(bank, run, {});
    EXPECT_TRUE((modes.array() >= 0).all() && (modes.array() < 3).all()) << R;
  }
}

}  // namespace
}  // namespace modebank
