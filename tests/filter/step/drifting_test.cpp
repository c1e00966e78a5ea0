// The drifting model: closed forms, missing samples, starts, rejected and unusual inputs; noise levels, by an
// independent numpy script (tests/golden/generate/drifting_levels.py) and laws.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/judge/statistics.hpp"
#include "filter/step/noise_density.hpp"
#include "ident/base/distributions.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using nlohmann::json;
using test::example_drifting;
using test::fixed;
using test::golden_rows;
using test::holed;
using test::near;
using test::simulate_drifting;
using test::with_levels;

constexpr double drift_digits = 1e-10;  // tolerance for two computations in double precision over a few hundred samples

TEST(StudentNoise, DensityIsTheSlopeOfTheProbabilityAndHasVarianceOne) {
  for (const double nu : {0.0, 2.5, 3.0, 8.0, 15.0}) {
    const StudentNoise noise(nu);
    for (const double x : {-4.0, -0.3, 0.0, 1.0, 7.0}) {
      const double h = 1e-4, slope = (noise.probability(x + h) - noise.probability(x - h)) / (2 * h);
      EXPECT_NEAR(std::exp(noise.log_density(x * x)), slope, 1e-7) << nu << " at " << x;
    }
    if (nu == 2.5) continue;  // the tails of the distribution are too long for numerical integration
    const double variance =
        integrate([&](double x) { return 2.0 * x * x * std::exp(noise.log_density(x * x)); }, 0.0, 2e4);
    EXPECT_NEAR(variance, 1.0, nu == 3.0 ? 1e-3 : 1e-6) << nu;
  }
  for (const double nu : {-1.0, 1.0, 2.0, double{INFINITY}, std::nan("")})
    EXPECT_THROW(StudentNoise{nu}, std::invalid_argument);
}

TEST(Drifting, FixedCoefficientsAndVarianceAreOneKalmanFilter) {
  for (const Index n : {1, 2, 3})
    for (const Index lags : {1, 3}) {
      Bank model = example_drifting(n, 2, lags);
      model.drift.rates = {0.0, 0.0, 1.0};
      model.running_noise.lam = 1.0;
      model.running_noise.nu = 0.0;
      const Trajectory run = simulate_drifting(model, 200, 3);
      const RunEvaluation drifting = evaluate_run(model, run, {}),
                          bank = evaluate_run(fixed(model), run, {FilterVariant::kf});
      for (const auto part : {&RunEvaluation::prediction, &RunEvaluation::innovation, &RunEvaluation::state,
                              &RunEvaluation::innovation_covariance})
        EXPECT_TRUE(near(drifting.*part, bank.*part, drift_digits));
      EXPECT_TRUE(near(drifting.pit, bank.pit, 1e3 * drift_digits));
      EXPECT_TRUE(near(drifting.log_density, bank.log_density, 1e3 * drift_digits));
      EXPECT_TRUE(near(drifting.nis, bank.nis, 1e3 * drift_digits));
      const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {1, 2, 6}),
                              of_bank = evaluate_horizons(fixed(model), run, {FilterVariant::kf}, {1, 2, 6});
      EXPECT_TRUE(near(ahead.log_density, of_bank.log_density, 1e3 * drift_digits));
      for (std::size_t h = 0; h < 3; ++h) {
        EXPECT_TRUE(near(ahead.error[h], of_bank.error[h], drift_digits));
        EXPECT_TRUE(near(ahead.pit[h], of_bank.pit[h], 1e3 * drift_digits));
      }
    }
}

TEST(Drifting, ScoresTheSamplesThatABankScores) {
  const auto nan = [](const Eigen::MatrixXd& x) { return Eigen::MatrixXd(x.array().isNaN().cast<double>()); };
  for (const Index n : {1, 2})
    for (const Index lags : {1, 3}) {
      Bank model = example_drifting(n, 1, lags);
      model.dt_s = 1.0;
      const Trajectory run = holed(simulate_drifting(model, 140, 5));
      const RunEvaluation drifting = evaluate_run(model, run, {}),
                          bank = evaluate_run(fixed(model), run, {FilterVariant::kf});
      each_part(drifting, bank, [&](const auto& a, const auto& b) { EXPECT_EQ(nan(a), nan(b)); });
      EXPECT_EQ(nan(drifting.log_density), nan(bank.log_density));
      EXPECT_EQ(nan(drifting.nis), nan(bank.nis));
      const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {5, 1, 2}),
                              of_bank = evaluate_horizons(fixed(model), run, {FilterVariant::kf}, {5, 1, 2});
      EXPECT_EQ(ahead.horizons, of_bank.horizons);
      EXPECT_EQ(nan(ahead.log_density), nan(of_bank.log_density));
      for (std::size_t h = 0; h < 3; ++h) EXPECT_EQ(nan(ahead.error[h]), nan(of_bank.error[h]));
    }
}

/// Outputs may share P only as long as sharing does not change the result: each is predicted as by a filter of one
/// output with the others as inputs.
TEST(Drifting, EveryOutputLearnsFromItsOwnSamples) {
  for (const double nu : {0.0, 5.0}) {
    Bank model = example_drifting(3, 1, 1);
    model.running_noise.nu = nu;
    Trajectory run = simulate_drifting(model, 80, 11);
    run.state(1, 20) = run.state(1, 21) = run.state(2, 21) = run.state(0, 50) = std::nan("");
    run.state.col(60).setConstant(std::nan(""));
    const RunEvaluation result = evaluate_run(model, run, {});
    const Eigen::MatrixXd theta = model.theta(0).reshaped(5, 3);
    Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(80);
    for (const Index i : {0, 1, 2}) {
      const Eigen::Vector<Index, 5> own_first(i, (i + 1) % 3, (i + 2) % 3, 3, 4);
      Bank one = one_mode_bank({1, 3, true}, theta.col(i)(own_first), model.noise_variance().segment(i, 1));
      one.drift = {model.drift.rates, model.drift.scale(own_first)};
      one.running_noise = {model.running_noise.lam, nu, model.running_noise.floor.segment(i, 1)};
      Trajectory alone = run;
      alone.state = run.state.row(i);
      alone.input.resize(3, 80);
      alone.input << result.state(own_first.segment(1, 2), Eigen::all), run.input;
      const RunEvaluation of_one = evaluate_run(one, alone, {});
      EXPECT_TRUE(near(result.prediction.row(i), of_one.prediction, drift_digits));
      const Eigen::ArrayXd densities = of_one.log_density;
      sum += densities.isNaN().select(0.0, densities);
    }
    sum(0) = sum(60) = std::nan("");
    EXPECT_TRUE(near(result.log_density, sum, drift_digits));
  }
}

/// Kolmogorov's distance of N pit values from the uniform distribution, times sqrt(N). If the model is correct, it
/// exceeds 1.95 once in a thousand times.
double scaled_distance(const Bank& filter, const Bank& truth, std::uint64_t seed) {
  const RunEvaluation e = evaluate_run(filter, simulate_drifting(truth, 3000, seed), {});
  std::vector<double> pit;
  for (const double value : e.pit.reshaped())
    if (!std::isnan(value)) pit.push_back(value);
  return kolmogorov_distance(pit) * std::sqrt(static_cast<double>(pit.size()));
}

TEST(Drifting, PitIsUniformWhereTheModelIsTrue) {
  Bank walking = example_drifting(1, 2, 2);
  walking.running_noise.lam = 1.0;  // the variance remains v0
  walking.running_noise.nu = 0.0;   // with other noise the filter of drifting coefficients is approximate
  walking.drift.rates = {0.05, 0.5, 0.95};
  Bank heavy = example_drifting(2, 1, 1);
  heavy.running_noise.lam = 1.0;
  heavy.running_noise.nu = 3.0;
  heavy.drift.rates = {0.0, 0.0, 1.0};
  Bank blind = walking;  // this filter assumes constant coefficients, and the test must detect the error
  blind.drift.rates.q = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(scaled_distance(walking, walking, seed), 1.95) << seed;
    EXPECT_LT(scaled_distance(heavy, heavy, seed), 1.95) << seed;
    EXPECT_GT(scaled_distance(blind, walking, seed), 3.0) << seed;
  }
}

TEST(DriftingFilter, RefusesWhatIsNone) {
  const Bank good = with_levels(example_drifting(2, 1, 2));
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
      [](Bank& m) { m.running_noise.horizon_factor.emplace_back(1, 2.0); },
      [](Bank& m) { m.running_noise.horizon_factor.emplace_back(5, 0.0); },
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
  odd[8] = std::nan("");  // theta(0, 0), after two numbers, z and the sizes of both
  EXPECT_THROW(filter.restore(odd), std::invalid_argument);
}

/// Any input must give finite numbers: huge values of an unstable model, a long gap, samples of every size.
TEST(DriftingFilter, StaysFiniteOnWildSamples) {
  for (const double huge : {1e8, 1e25}) {
    Bank model = example_drifting(1, 1, 2);
    model.modes.front().model = unpack(model.structure, Eigen::VectorXd::Ones(model.structure.parameters()));
    Trajectory run = simulate_drifting(example_drifting(1, 1, 2), 300, 4);
    run.state.col(50).setConstant(huge);
    run.state.middleCols(100, 120).setConstant(std::nan(""));
    const RunEvaluation e = evaluate_run(model, run, {});
    EXPECT_TRUE(e.state.rightCols(298).allFinite());
    for (Index k = 2; k < 300; ++k) ASSERT_TRUE(std::isfinite(e.log_density(k)) || (k >= 100 && k < 220)) << k;
    const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {40});
    for (Index k = 41; k < 300; ++k) ASSERT_TRUE(std::isfinite(ahead.log_density(0, k)) || (k >= 100 && k < 220)) << k;
  }
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bank model = example_drifting(2, 1, 2);
    if (seed > 10) model = with_levels(model);
    model.drift.rates = {seed % 2 == 0 ? 0.0 : 0.1, 1e4, 1.0};
    Trajectory run = simulate_drifting(example_drifting(2, 1, 2), 200, seed);
    std::mt19937_64 generator(seed);
    boost::random::uniform_01<double> uniform;
    for (double& value : run.state.reshaped()) value *= std::pow(10.0, 29.0 * uniform(generator));
    const RunEvaluation e = evaluate_run(model, run, {});
    EXPECT_TRUE(e.state.rightCols(198).allFinite() && e.log_density.tail(198).allFinite());
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
      for (const auto part : {&RunEvaluation::prediction, &RunEvaluation::innovation_covariance, &RunEvaluation::pit})
        EXPECT_TRUE(near(a.*part, b.*part, law_digits)) << levels;
      EXPECT_TRUE(near(a.log_density, b.log_density, 1e2 * law_digits)) << levels;
      const HorizonEvaluation of_plain = evaluate_horizons(plain, run, {}, {1, 4}),
                              of_levels = evaluate_horizons(model, run, {}, {1, 4});
      EXPECT_TRUE(near(of_plain.log_density, of_levels.log_density, 1e2 * law_digits)) << levels;
      for (const std::size_t h : {0, 1}) EXPECT_TRUE(near(of_plain.pit[h], of_levels.pit[h], law_digits)) << levels;
    }
  }
}

}  // namespace
}  // namespace modebank
