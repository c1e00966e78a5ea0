// One linear model by prediction errors: against scipy, and on plants whose truth is known.
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "ident/lag/linear_stage.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;

/// A heater of 60 s and 0.80 K/W at 20 degrees, sampled once a second.
struct Heater {
  Index runs = 6, samples = 600, delay = 3;
  double gain = 0.8, ambient = 20.0, wander = 0.0, outliers = 0.0;
  static constexpr double time_s = 60.0, R = 0.01, Q = 0.0009, power = 50.0;
  const double a = std::exp(-1.0 / time_s);
};

Recording simulate(const Heater& heater, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform;
  std::vector<Trajectory> runs;
  for (Index r = 0; r < heater.runs; ++r) {
    MatrixXd y(1, heater.samples), u(1, heater.samples);
    double x = 0.0, level = heater.ambient;
    for (Index k = 0; k < heater.samples; ++k) {
      u(0, k) = k % 20 == 0 ? heater.power * 2.0 * uniform(generator) : u(0, k - 1);
      level += heater.wander * normal(generator);
      const double acting = u(0, std::max<Index>(0, k - heater.delay));
      x = heater.a * x + (1.0 - heater.a) * heater.gain * acting + std::sqrt(heater.Q) * normal(generator);
      y(0, k) = level + x + std::sqrt(heater.R) * normal(generator);
      if (uniform(generator) < heater.outliers) y(0, k) += 2.0 * normal(generator);
    }
    runs.push_back(make_run(y, u));
    runs.back().run = "run" + std::to_string(r);
  }
  return make_recording(std::move(runs));
}

const ArmaxFit& fit_of(const LinearStage& stage, const ArmaxOrder& order) {
  for (const ArmaxFit& candidate : stage.candidates)
    if (candidate.order == order) return candidate;
  throw std::out_of_range("no such candidate");
}

/// Deviation of gain and of time constant from the truth, in stated errors, of a model of one lag each.
std::array<double, 2> deviations(const ArmaxFit& fit, const Heater& heater) {
  const double a = fit.theta(0, 0), b = fit.theta(0, 1);
  VectorXd gain_by = VectorXd::Zero(fit.covariance.rows()), time_by = gain_by;
  gain_by.head(2) << b / (1.0 - a) / (1.0 - a), 1.0 / (1.0 - a);
  time_by(0) = 1.0 / (a * std::log(a) * std::log(a));
  const auto error = [&](const VectorXd& by) { return std::sqrt(by.dot(fit.covariance * by)); };
  return {(b / (1.0 - a) - heater.gain) / error(gain_by), (-1.0 / std::log(a) - heater.time_s) / error(time_by)};
}

TEST(Armax, EqualsScipy) {
  const nlohmann::json golden_cases = read_golden("armax");
  for (const auto& [name, of] : golden_cases.items()) {
    std::vector<Trajectory> runs;
    for (const auto& run : of["runs"]) runs.push_back(make_run(golden_rows(run["state"]), golden_rows(run["input"])));
    const LinearStage stage = find_linear_stage(make_recording(std::move(runs)));
    for (const auto& expected : of["fits"]) {
      const auto& order = expected["order"];
      const ArmaxFit& fit = fit_of(stage, {order[0] == 1, order[1], order[2], order[3]});
      EXPECT_EQ(fit.delays, of["delays"].get<std::vector<Index>>());
      MatrixXd all(fit.theta.rows(), fit.theta.cols() + fit.C.cols()), golden = all;
      all << fit.theta, fit.C;
      golden << golden_rows(expected["theta"]), golden_rows(expected["C"]);
      EXPECT_TRUE(near((all - golden).cwiseQuotient(golden_rows(expected["standard_error"])), 0.0 * all, 0.01)) << name;
      EXPECT_TRUE(near(fit.S, golden_rows(expected["S"]), 1e-6)) << name;
      const NoiseVariances noise = noise_variances(fit);
      EXPECT_TRUE(near(noise.R, golden_rows(expected["R"]), 2e-5)) << name;
      EXPECT_TRUE(near(noise.Q, golden_rows(expected["Q"]), 2e-5)) << name;
    }
  }
}

TEST(Armax, DifferencesWinWhereTheLevelWanders) {
  Heater heater;
  heater.wander = 0.05;
  const LinearStage stage = find_linear_stage(simulate(heater, 1));
  ASSERT_TRUE(stage.fit().order.differences);
  for (const double deviation : deviations(fit_of(stage, {true, 1, 1, 2}), heater)) EXPECT_LT(std::abs(deviation), 3.0);
}

TEST(Armax, OutliersDoNotDecide) {
  Heater heater;
  heater.outliers = 0.03;  // of variance 4, so that the variance of the measurement noise is 0.13 with them
  const ArmaxFit fit = fit_of(find_linear_stage(simulate(heater, 2)), {false, 1, 1, 1});
  EXPECT_NEAR(fit.theta(0, 1) / (1.0 - fit.theta(0, 0)), heater.gain, 0.01 * heater.gain);
  EXPECT_NEAR(-1.0 / std::log(fit.theta(0, 0)), heater.time_s, 0.02 * heater.time_s);
  EXPECT_LT(noise_variances(fit).R(0), 0.05);
}

TEST(Armax, LagsDoNotReachAcrossGaps) {
  const Recording whole = simulate({}, 3);
  Recording parts = whole, gap = whole;
  parts.runs.clear();
  for (std::size_t r = 0; r < whole.runs.size(); ++r) {
    const Trajectory& run = whole.runs[r];
    parts.runs.push_back(make_run(run.state.leftCols(250), run.input.leftCols(250)));
    parts.runs.push_back(make_run(run.state.rightCols(350), run.input.rightCols(350)));
    gap.runs[r].time_s.tail(350).array() += 100.0;
  }
  const ArmaxOrder order{false, 1, 1, 1};
  EXPECT_TRUE(same_bits(fit_of(find_linear_stage(gap), order).theta, fit_of(find_linear_stage(parts), order).theta));
}

TEST(Armax, OneRunIsCutAndFewSamplesGiveNothing) {
  Heater heater;
  heater.runs = 1;
  heater.samples = 2000;
  Recording recording = simulate(heater, 4);
  const LinearStage stage = find_linear_stage(recording);
  EXPECT_FALSE(stage.by_runs);
  EXPECT_EQ(stage.rows.size(), 5);
  for (const double deviation : deviations(fit_of(stage, {false, 1, 1, 1}), heater))
    EXPECT_LT(std::abs(deviation), 3.0);
  for (const Index samples : {0, 1, 2, 40, 99, 130, 159, 200, 300}) {
    const Trajectory& run = recording.runs[0];
    const Recording few = make_recording({make_run(run.state.leftCols(samples), run.input.leftCols(samples))});
    EXPECT_EQ(find_linear_stage(few).candidates.empty(), samples < 160) << samples;
  }
  Recording copies = recording;  // of the input, one sample later and without noise
  copies.runs[0].state.rightCols(heater.samples - 1) = recording.runs[0].input.leftCols(heater.samples - 1);
  EXPECT_THAT(find_linear_stage(copies).fit().delays, ElementsAre(1));
  recording.runs[0].state.setConstant(20.0);
  EXPECT_TRUE(find_linear_stage(recording).candidates.empty());
}

TEST(Armax, WorksWithoutInputsAndWithADelayOfZero) {
  Heater heater;
  heater.delay = 0;
  Recording recording = simulate(heater, 5);
  EXPECT_THAT(find_linear_stage(recording).fit().delays, ElementsAre(1));
  LinearStageOptions options;
  options.least_delay = {0};
  const LinearStage stage = find_linear_stage(recording, options);
  EXPECT_THAT(stage.fit().delays, ElementsAre(0));
  options.only = {{false, 2, 3, 0}, {1}};
  EXPECT_THAT(find_linear_stage(recording, options).fit().delays, ElementsAre(1));
  recording.inputs.clear();
  for (Trajectory& run : recording.runs) run.input.resize(0, run.samples());
  EXPECT_EQ(find_linear_stage(recording).fit().order.input_lags, 0);
}

TEST(Armax, LevelsThreadsAndAStatedNoise) {
  const Recording recording = simulate({}, 6);
  Recording high = recording;
  for (Trajectory& run : high.runs) run.state.array() += 101325.0, run.input.array() += 9999.0;
  const LinearStage stage = find_linear_stage(recording), above = find_linear_stage(high);
  EXPECT_TRUE(near(above.fit().theta.leftCols(2), stage.fit().theta.leftCols(2), 1e-7));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same_bits(find_linear_stage(recording).fit().theta, stage.fit().theta));
  const NoiseVariances noise = noise_variances(stage.fit(), VectorXd::Constant(1, 0.005));
  EXPECT_EQ(noise.R(0), 0.005);
  EXPECT_GT(noise.Q(0), 0.0);
}

}  // namespace
}  // namespace modebank::test
