// Predictions without measurements from a filter's state, and continuing from a snapshot.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "filter/judge/horizon.hpp"
#include "filter/step/combined_filter.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Index;

constexpr double two_texts = 1e-10;  // fixed and dynamic sizes differ by rounding errors

struct NamedBank {
  std::string name;
  Bank bank;
  FilterOptions options = {};
};

Bank with_logit_of_state_and_input() {
  Bank bank = test::example_bank(2, 1, 3);
  bank.transition_logit = {MatrixXd{{0.5, -1.0, 2.0}, {-2.0, 0.3, 0.1}, {0.0, 1.0, -0.5}}, VectorXd::Constant(3, 0.1)};
  return bank;
}

Bank of_lags(const InputDelays& delay) {
  const LinearStructure s{2, std::ssize(delay.listed()), true, 3, 2, delay};
  Bank bank = test::arx_bank(s, test::stable_theta(s));
  bank.modes.push_back(bank.modes.front());
  bank.modes[1].model.A.topRows(2) *= 0.5;
  bank.modes[1].Q *= 4.0;
  bank.transition = TransitionMatrix::sticky(2, 0.8);
  bank.initial_probability = VectorXd::Constant(2, 0.5);
  return bank;
}

Bank with_running_noise() {
  Bank bank = test::example_drifting(2, 1, 2);
  bank.running_noise.horizon_factor = {{2, 1.5}, {4, 2.0}};
  return bank;
}

std::vector<NamedBank> banks() {
  Bank quantised = test::example_bank(1, 1, 2);
  quantised.quantum = VectorXd::Constant(1, 0.05);
  Bank quick = test::example_bank(1, 1, 2);
  quick.dt_s = 1.0;  // gaps consist of several steps
  return {{"few states", test::example_bank(2, 1, 3)},
          {"many states", test::example_bank(5, 2, 2)},
          {"one mode", test::single_mode(test::example_bank(3, 2, 2), 1), {FilterVariant::kf}},
          {"the paper's", test::example_bank(2, 1, 3), {FilterVariant::salvi2025}},
          {"gaps", quick},
          {"logit", with_logit_of_state_and_input()},
          {"lags without delay", of_lags(0)},
          {"lags", of_lags(1)},
          {"lags with delay 3", of_lags(3)},
          {"lags with delays", of_lags(InputDelays({4, 1, 2}))},
          {"quantised", quantised},
          {"drift with running noise", with_running_noise()},
          {"drift with noise levels", test::with_levels(with_running_noise())}};
}

filter::Bank installed(const Bank& bank) { return filter::Bank(std::make_shared<const Bank>(bank)); }

/// Samples with a gap in time after sample 12 and a missing one at sample 15.
Trajectory run_of(const Bank& bank) {
  Trajectory run = test::any_run(bank.structure, 40);
  run.time_s.tail(27).array() += 2.0;
  run.state *= 0.1;
  run.state.col(15).setConstant(std::nan(""));
  if (bank.is_quantised()) run.state = bank.quantum(0) * (run.state / bank.quantum(0)).array().round();
  return run;
}

const filter::Estimate& take(filter::BankFilter& live, const Bank& bank, Index k) {
  const Trajectory run = run_of(bank);
  return live.step(run.time_s(k), VectorXd(run.input.col(k)), VectorXd(run.state.col(k)));
}

Matrix planned(const Bank& bank, Index now, Index count) {
  return to_matrix(run_of(bank).input.middleCols(now + 1, count));
}

void expect_same_bits(const filter::Estimate& a, const filter::Estimate& b) {
  each_part(a, b, [](const auto& x, const auto& y) { EXPECT_TRUE(test::near(view(x), view(y), 0.0)); });
  EXPECT_TRUE(test::near(Eigen::Vector2d(a.log_density, a.nis), Eigen::Vector2d(b.log_density, b.nis), 0.0));
  EXPECT_EQ(a.steps, b.steps);
}

TEST(Forecast, OfTheNextSampleIsThePredictionOfTheNextStep) {
  for (const auto& [name, bank, options] : banks()) {
    SCOPED_TRACE(name);
    filter::BankFilter live(installed(bank), options);
    for (Index k = 0; k < 25; ++k) {
      const std::vector<filter::Forecast> ahead = live.forecast(planned(bank, k - 1, 1), 1);
      const bool predicts = live.started();
      const filter::Estimate& said = take(live, bank, k);
      if (!predicts || said.steps != 1) continue;
      ASSERT_EQ(ahead.size(), 1U);
      EXPECT_TRUE(test::near(view(ahead[0].state), view(said.prediction), two_texts)) << k;
      EXPECT_TRUE(test::near(view(ahead[0].mode_probability), view(said.mode_probability_predicted), two_texts)) << k;
      const MatrixXd S = bank.C * view(ahead[0].covariance) * bank.C.transpose() + bank.recording_noise();
      EXPECT_TRUE(test::near(S, view(said.innovation_covariance), two_texts)) << k;
    }
  }
}

TEST(Forecast, IsWhatStepsWithoutMeasurementsPredict) {
  for (const auto& [name, bank, options] : banks()) {
    if (name.starts_with("drift")) continue;  // unstable coefficients are contracted in predictions
    SCOPED_TRACE(name);
    filter::BankFilter live(installed(bank), options);
    for (Index k = 0; k < 20; ++k) take(live, bank, k);
    const Trajectory run = run_of(bank);
    const Index steps = 7;
    const std::vector<filter::Forecast> ahead =
        live.forecast(planned(bank, 19, std::max<Index>(steps - bank.structure.input_delay.earliest(), 0)), steps);
    for (Index i = 0; i < steps; ++i) {
      const filter::Estimate& said =
          live.step(std::nan(""), VectorXd(run.input.col(20 + i)), VectorXd(std::nan("") * run.state.col(0)));
      const filter::Forecast& forecast = ahead[i];
      EXPECT_TRUE(test::near(view(forecast.state), view(said.state), two_texts)) << i;
      EXPECT_TRUE(test::near(view(forecast.covariance), view(said.covariance), two_texts)) << i;
      EXPECT_TRUE(test::near(view(forecast.mode_probability), view(said.mode_probability), two_texts)) << i;
    }
  }
}

TEST(Forecast, IsWhatTheJudgeScores) {
  for (const auto& [name, bank, options] : banks()) {
    SCOPED_TRACE(name);
    const Trajectory run = run_of(bank);
    const HorizonEvaluation judged = evaluate_horizons(bank, run, options, {1, 2, 3, 4});
    filter::BankFilter live(installed(bank), options);
    const Index steps = 4;
    for (Index k = 0; k + steps < run.samples(); ++k) {
      take(live, bank, k);
      if (k >= 9 && k <= 12) continue;  // a gap follows, in which the evaluation takes more steps
      const std::vector<filter::Forecast> ahead = live.forecast(planned(bank, k, steps), steps);
      for (Index h = 1; h <= steps && live.started(); ++h) {
        const VectorXd error = judged.error[h - 1].col(k + h);
        if (!error.allFinite()) continue;
        const VectorXd y = bank.C * view(ahead[h - 1].state);
        EXPECT_TRUE(test::near(run.state.col(k + h) - y, error, two_texts)) << k << " + " << h;
      }
    }
  }
}

TEST(Forecast, BeforeTheStartIsNotANumber) {
  const Bank bank = test::example_bank(2, 1, 3);
  const std::vector<filter::Forecast> ahead = filter::BankFilter(installed(bank)).forecast(planned(bank, 0, 2), 3);
  ASSERT_EQ(ahead.size(), 3U);
  EXPECT_TRUE(std::isnan(ahead[2].state[0]) && std::isnan(ahead[2].covariance(1, 1)));
  EXPECT_TRUE(test::near(view(ahead[2].mode_probability), bank.initial_probability, 0.0));
}

TEST(Forecast, RefusesMissingInputs) {
  const Bank bank = of_lags(1);
  filter::BankFilter live(installed(bank));
  for (Index k = 0; k < 10; ++k) take(live, bank, k);
  EXPECT_NO_THROW(live.forecast(planned(bank, 9, 3), 4));
  for (const Matrix& inputs : {planned(bank, 9, 2), Matrix(), Matrix(2, 4), Matrix(1, 4, std::nan(""))})
    EXPECT_THROW(live.forecast(inputs, 4), std::invalid_argument);
  EXPECT_THROW(live.forecast(planned(bank, 9, 3), 0), std::invalid_argument);
}

TEST(Snapshot, OfTheDescribedBankGoesOnToTheBit) {
  for (const auto& [name, bank, options] : banks())
    for (const Index stop : {0, 2, 14}) {
      SCOPED_TRACE(name + " after " + std::to_string(stop));
      filter::BankFilter first(installed(bank), options);
      filter::BankFilter second(filter::Bank(installed(bank).description()), options);  // the same bank
      for (Index k = 0; k < stop; ++k) take(first, bank, k);
      take(second, bank, 3);  // this filter has processed other samples
      second.restore(first.snapshot());
      EXPECT_EQ(second.started(), first.started());
      for (Index k = stop; k < 25; ++k) {
        expect_same_bits(take(second, bank, k), take(first, bank, k));
        first.forecast(planned(bank, k, 5), 5);  // leaves the filter as it was
      }
      second.restart();
      EXPECT_FALSE(second.started());
      if (bank.is_quantised()) continue;  // transforms are drawn by the number of samples since construction
      filter::BankFilter fresh(installed(bank), options);
      for (Index k = 0; k < 20; ++k) expect_same_bits(take(second, bank, k), take(fresh, bank, k));
    }
}

TEST(Snapshot, IsRefusedWhereItDoesNotFit) {
  const Bank bank = test::example_bank(2, 1, 3);
  filter::BankFilter live(installed(bank)), other(installed(test::example_bank(3, 1, 3)));
  for (Index k = 0; k < 10; ++k) take(live, bank, k);
  const std::vector<double> good = live.snapshot();
  EXPECT_THROW(other.restore(good), std::invalid_argument);
  EXPECT_THROW(live.restore({}), std::invalid_argument);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::vector<double> cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i)), longer = good;
    EXPECT_THROW(live.restore(cut), std::invalid_argument) << i;
    longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(i), 1e18);
    EXPECT_THROW(live.restore(longer), std::invalid_argument) << i;
  }
  const std::size_t end = good.size();  // ... inputs, measurements (2), samples, whole, time, all samples
  const std::vector<std::pair<std::size_t, double>> spoil = {
      {1, 2.0},                  // started
      {7, std::nan("")},         // a mean
      {9, 3.0},                  // the size of a covariance
      {10, -1.0},                // a variance
      {end - 11, std::nan("")},  // an input
      {end - 10, 1.0},           // the size of the measurements
      {end - 4, 11.0},           // more whole samples than samples
  };
  for (const auto& [i, value] : spoil) {
    std::vector<double> spoilt = good;
    spoilt[i] = value;
    EXPECT_THROW(live.restore(spoilt), std::invalid_argument) << i;
  }
  EXPECT_EQ(live.snapshot(), good);
}

/// Weights by the densities of earlier samples; a filter that has not started has none.
TEST(CombinedFilter, IsTheMixtureOfItsFilters) {
  const Bank drifting = test::example_drifting(2, 1, 3), bank = test::example_bank(2, 1, 3);
  std::vector<BankFilter> alone, both;
  for (std::vector<BankFilter>* filters : {&alone, &both})
    for (const Bank& one : {bank, drifting}) filters->emplace_back(one, FilterOptions{});
  CombinedFilter filter(std::move(both), {0.3, 0.7});
  filter::ForecastWeights weights({0.3, 0.7}, 1);
  Trajectory run = test::simulate_drifting(drifting, 40, 1);
  run.state(0, 20) = run.state(0, 25) = run.state(1, 25) = std::nan("");
  for (Index k = 0; k < run.samples(); ++k) {
    const FilterEstimate& mixed = filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    const FilterEstimate& a = alone[0].step(run.time_s(k), run.input.col(k), run.state.col(k));
    const FilterEstimate& b = alone[1].step(run.time_s(k), run.input.col(k), run.state.col(k));
    const double w = std::isnan(b.prediction(0)) ? 1.0 : weights.weights()[0];
    weights.observe({a.log_density, b.log_density});
    if (k == 0) continue;
    const VectorXd x = w == 1.0 ? a.prediction : VectorXd(w * a.prediction + (1.0 - w) * b.prediction.head(2));
    EXPECT_TRUE(test::near(mixed.prediction, x, 1e-12)) << k;
    if (w == 1.0) continue;
    const VectorXd of_a = a.prediction - x, of_b = b.prediction.head(2) - x;
    const MatrixXd S = w * (a.innovation_covariance + of_a * of_a.transpose()) +
                       (1.0 - w) * (b.innovation_covariance + of_b * of_b.transpose());
    EXPECT_TRUE(test::near(mixed.innovation_covariance, S, 1e-12)) << k;
    if (k == 25) continue;
    EXPECT_NEAR(mixed.log_density, std::log(w * std::exp(a.log_density) + (1.0 - w) * std::exp(b.log_density)), 1e-10);
  }
}

}  // namespace
}  // namespace modebank
