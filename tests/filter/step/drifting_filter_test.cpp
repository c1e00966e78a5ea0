// The drifting model sample by sample: rejected inputs, unusual samples; noise levels, by an independent numpy script
// (tests/golden/generate/drifting_levels.py) and laws.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/step/bank_filter.hpp"
#include "filter/step/samples.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using nlohmann::json;
using test::example_drifting;
using test::golden_rows;
using test::holed;
using test::near;
using test::simulate_drifting;
using test::with_levels;

TEST(DriftingFilter, RefusesWhatIsNone) {
  const Bank good = test::with_levels(example_drifting(2, 1, 2));
  EXPECT_NO_THROW(BankFilter(good, {}));
  const std::vector<std::function<void(Bank&)>> spoil = {
      [](Bank& m) { m.modes.front().model.A(0, 0) = std::nan(""); },
      [](Bank& m) { m.modes.push_back(m.modes.front()); },
      [](Bank& m) { m.drift = {}; },
      [](Bank& m) { m.R(0, 0) = 1e-3; },
      [](Bank& m) { m.drift.scale(1) = 0.0; },
      [](Bank& m) { m.noise_variance()(0) = 0.0; },
      [](Bank& m) { m.running_noise.floor(1) = -1.0; },
      [](Bank& m) { m.drift.rates.q = -1.0; },
      [](Bank& m) { m.drift.rates.p0 = INFINITY; },
      [](Bank& m) { m.drift.rates.leak = 1.1; },
      [](Bank& m) { m.running_noise.lam = std::nan(""); },
      [](Bank& m) { m.running_noise.nu = 2.0; },
      [](Bank& m) { m.running_noise.level(0, 1) = 0.0; },
      [](Bank& m) { m.running_noise.switching(0, 0) = 0.5; },  // the row sums to 0.6
      [](Bank& m) {
        m.running_noise.horizon_factor = {{1, 2.0}};
      },
      [](Bank& m) {
        m.running_noise.horizon_factor = {{5, 0.0}};
      },
  };
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    Bank bad = good;
    spoil[i](bad);
    EXPECT_THROW(BankFilter(bad, {}), std::invalid_argument) << i;
  }
  BankFilter filter(good, {});
  for (const Index lags : {1, 2})  // one without levels
    EXPECT_THROW(filter.restore(BankFilter(example_drifting(2, 1, lags), {}).snapshot()), std::invalid_argument);
  std::vector<double> odd = filter.snapshot();
  odd[10] = std::nan("");  // theta(0, 0), after two numbers, z and the sizes of both
  EXPECT_THROW(filter.restore(odd), std::invalid_argument);
}

/// Any input must give finite numbers.
TEST(DriftingFilter, StaysFiniteOnWildSamples) {
  for (const double huge : {1e8, 1e25}) {
    Bank model = example_drifting(1, 1, 2);
    model.modes.front().model =
        unpack(model.structure, Eigen::VectorXd::Ones(model.structure.parameters()));  // unstable
    Trajectory run = simulate_drifting(example_drifting(1, 1, 2), 300, 4);
    run.state.col(50).setConstant(huge);
    run.state.middleCols(100, 120).setConstant(std::nan(""));
    const RunEvaluation e = evaluate_run(model, run, {});
    EXPECT_TRUE(e.state.rightCols(298).allFinite());
    for (Index k = 2; k < 300; ++k) ASSERT_TRUE(std::isfinite(e.log_density(k)) || (k >= 100 && k < 220)) << k;
    const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {40});
    for (Index k = 41; k < 300; ++k) ASSERT_TRUE(std::isfinite(ahead.log_density(0, k)) || (k >= 100 && k < 220)) << k;
  }
}

TEST(DriftingFilter, StaysFiniteWhereSamplesAreOfEverySize) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bank model = example_drifting(2, 1, 2);
    if (seed > 10) model = test::with_levels(model);
    model.drift.rates = {seed % 2 == 0 ? 0.0 : 0.1, 1e4, 1.0};
    Trajectory run = simulate_drifting(example_drifting(2, 1, 2), 200, seed);
    std::mt19937_64 generator(seed);
    for (double& value : run.state.reshaped())
      value *= std::pow(10.0, 29.0 * boost::random::uniform_01<double>()(generator));
    const RunEvaluation e = evaluate_run(model, run, {});
    EXPECT_TRUE(e.state.rightCols(198).allFinite());
    EXPECT_TRUE(e.log_density.tail(198).allFinite());
    EXPECT_TRUE(e.innovation_covariance.rightCols(198).allFinite());
  }
}

constexpr double golden_digits = 1e-10, law_digits = 1e-12;

Bank golden_bank(const json& golden, double nu) {
  const LinearStructure structure{1, 1, true, 2, 2, 1};
  Eigen::VectorXd theta = golden_rows(golden.at("theta0"));
  theta(0) -= 1.0;  // increment form
  Bank bank = one_mode_bank(structure, theta, Eigen::VectorXd::Constant(1, golden.at("v0").get<double>()));
  bank.drift = {{golden.at("rates")[0], golden.at("rates")[1], golden.at("rates")[2]}, golden_rows(golden.at("scale"))};
  bank.running_noise = {golden.at("lam"), nu, Eigen::VectorXd::Constant(1, golden.at("floor").get<double>())};
  bank.running_noise.level = golden_rows(golden.at("level")).transpose();
  bank.running_noise.switching = golden_rows(golden.at("T"));
  return bank;
}

TEST(DriftingLevels, AreNumpys) {
  const json golden = test::read_golden("drifting_levels");
  Trajectory run;
  run.state = golden_rows(golden.at("y")).transpose();
  run.input = golden_rows(golden.at("u")).transpose();
  const Index missing = golden.at("missing"), ahead = golden.at("ahead");
  run.state(0, missing) = std::nan("");
  for (const json& expected : golden.at("expected")) {
    const auto of = [&](const char* name, Index k) { return golden_rows(expected.at(name))(k, 0); };
    const Bank bank = golden_bank(golden, expected.at("nu"));
    const Eigen::MatrixXd probability = golden_rows(expected.at("probability"));
    BankFilter filter(bank, {});
    DriftingFilter equations(bank);
    const RunInstants instants(bank, run);
    for (Index k = 0; k < run.samples(); ++k) {
      const FilterEstimate& said = filter.step(not_a_number, run.input.col(k), run.state.col(k));
      if (k >= 1) follow(instants, k - 1, run, equations);
      if (k < 2) continue;
      EXPECT_NEAR(said.prediction(0), of("prediction", k - 2), golden_digits) << k;
      EXPECT_NEAR(said.innovation_covariance(0, 0), of("variance", k - 2), golden_digits) << k;
      if (k != missing) {
        EXPECT_NEAR(said.log_density, of("log_density", k - 2), golden_digits) << k;
      }
      EXPECT_NEAR(equations.variance()(0), of("v", k - 2), golden_digits) << k;
      EXPECT_TRUE(near(equations.level(), probability.row(k - 2).transpose(), golden_digits)) << k;
      EXPECT_NEAR(equations.level().sum(), 1.0, law_digits);
    }
    const HorizonEvaluation far = evaluate_horizons(bank, run, {}, {ahead});
    for (Index k = 1 + ahead; k < run.samples(); ++k) {
      if (k == missing) continue;
      EXPECT_NEAR(far.error[0](0, k), of("far_error", k - 1 - ahead), golden_digits) << k;
      EXPECT_NEAR(far.log_density(0, k), of("far_density", k - 1 - ahead), golden_digits) << k;
    }
  }
}

/// One level of 1, and three equal ones, are the model without levels.
TEST(DriftingLevels, EqualLevelsAreNone) {
  for (const double nu : {0.0, 5.0}) {
    Bank plain = example_drifting(2, 1, 2);
    plain.dt_s = 1.0;
    plain.running_noise.nu = nu;
    plain.running_noise.horizon_factor = {{2, 1.5}};
    const Trajectory run = holed(simulate_drifting(plain, 140, 5));
    for (const Index levels : {1, 3}) {
      Bank model = with_levels(plain);
      model.running_noise.level = Eigen::MatrixXd::Ones(2, levels);
      if (levels == 1) model.running_noise.switching = Eigen::MatrixXd::Ones(1, 1);
      const RunEvaluation a = evaluate_run(plain, run, {}), b = evaluate_run(model, run, {});
      EXPECT_TRUE(near(a.prediction, b.prediction, law_digits)) << levels;
      EXPECT_TRUE(near(a.innovation_covariance, b.innovation_covariance, law_digits)) << levels;
      EXPECT_TRUE(near(a.log_density, b.log_density, 1e2 * law_digits)) << levels;
      EXPECT_TRUE(near(a.pit, b.pit, law_digits)) << levels;
      const HorizonEvaluation of_plain = evaluate_horizons(plain, run, {}, {1, 4}),
                              of_levels = evaluate_horizons(model, run, {}, {1, 4});
      EXPECT_TRUE(near(of_plain.log_density, of_levels.log_density, 1e2 * law_digits)) << levels;
      for (const std::size_t h : {0, 1}) EXPECT_TRUE(near(of_plain.pit[h], of_levels.pit[h], law_digits)) << levels;
    }
  }
}

}  // namespace
}  // namespace modebank
