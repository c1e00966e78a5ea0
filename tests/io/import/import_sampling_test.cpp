// Logs that are faster than data.rate_hz, and logs whose time steps scatter.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class ImportSampling : public test::ImportFixture {
 protected:
  ImportSampling() {
    options.states.clear();
    options.inputs = "log.csv";
  }

  using Signal = std::function<double(double)>;

  /// A log with `rows` rows at the given times.
  Trajectory read(const std::function<double(int)>& time, const Signal& x, const Signal& u, int rows = 1000) {
    std::string content = "time,x,u\n";
    for (int k = 0; k < rows; ++k) content += fmt::format("{:.9f},{:.9f},{:.9f}\n", time(k), x(time(k)), u(time(k)));
    write("log.csv", content);
    data = import();
    return data.recording.runs.at(0);
  }

  ImportedData data;
};

double at_100_hz(int k) { return 0.01 * k; }
double slow(double t) { return std::sin(0.8 * t); }
double vibration(double t) { return std::sin(2.0 * std::numbers::pi * 45.0 * t + 0.3); }
double held(double t) { return std::floor(t / 0.37 + 1e-6); }

TEST_F(ImportSampling, VibrationAboveHalfTheNewRateIsAveragedAway) {
  options.rate_hz = 10.0;
  const Trajectory run = read(
      at_100_hz, [](double t) { return slow(t) + vibration(t); },
      [](double t) { return 2.0 * slow(t) + vibration(t); });
  ASSERT_EQ(run.samples(), 99) << "no whole step ends at the first row";
  for (Index k = 0; k < run.samples(); ++k) {
    const double t = run.time_s(k);
    EXPECT_NEAR(t, 0.1 * static_cast<double>(k + 1), 1e-9);
    const double mean = (std::cos(0.8 * (t - 0.1)) - std::cos(0.8 * t)) / 0.08;  // mean of the slow part over one step
    EXPECT_NEAR(run.state(0, k), mean, 0.12) << t;
    EXPECT_NEAR(run.input(0, k), 2.0 * mean, 0.12) << t;
  }
  EXPECT_THAT(data.notes,
              Contains(AllOf(HasSubstr("at 10 Hz x, u are the mean over the step"), Not(HasSubstr("half")))));
}

TEST_F(ImportSampling, EndPointsOfAStepWeighHalf) {
  options.rate_hz = 10.0;
  const auto x = [](double t) { return std::cos(91.0 * t * t); };
  const Trajectory run = read(at_100_hz, x, held);
  for (Index k = 0; k < run.samples(); ++k) {
    double mean = 0.0;
    for (int i = 0; i <= 10; ++i) mean += (i == 0 || i == 10 ? 0.05 : 0.1) * x(at_100_hz(static_cast<int>(10 * k) + i));
    EXPECT_NEAR(run.state(0, k), mean, 1e-8);
    EXPECT_EQ(run.input(0, k), held(run.time_s(k))) << "a value that is held is picked";
  }
  EXPECT_THAT(data.notes, Contains(AllOf(HasSubstr("x is the mean"), HasSubstr("half a step (0.05 s) against u"))));
}

TEST_F(ImportSampling, HeldColumnsArePickedAndSoIsARateNearTheLogs) {
  options.rate_hz = 10.0;
  const Trajectory run = read(
      at_100_hz, [](double t) { return std::sin(std::floor(10.0 * t + 1e-6)); }, held);
  ASSERT_EQ(run.samples(), 100);
  for (Index k = 0; k < run.samples(); ++k) EXPECT_NEAR(run.state(0, k), std::sin(static_cast<double>(k)), 1e-8);
  EXPECT_THAT(data.notes, IsEmpty());
  options.rate_hz = 90.0;
  EXPECT_NEAR(read(at_100_hz, slow, held).state(0, 45), slow(0.5), 1e-5);
}

/// The values of a slower sensor, in a table whose rows come from a faster sensor.
TEST_F(ImportSampling, ColumnsWithValuesInFewRowsArePicked) {
  std::string content = "time,x,u\n";
  for (int k = 0; k < 1000; ++k)
    content += fmt::format("{:.2f},{:.9f},{}\n", at_100_hz(k), slow(at_100_hz(k)),
                           k % 5 == 0 ? fmt::format("{:.9f}", slow(at_100_hz(k))) : "");
  write("log.csv", content);
  options.rate_hz = 10.0;
  options.missing = Missing::predict;
  const Trajectory run = import().recording.runs.at(0);
  for (Index k = 0; k < run.samples(); ++k) EXPECT_NEAR(run.input(0, k), slow(run.time_s(k)), 1e-8) << k;
}

/// The data from which a bank was learned determine how new data are read.
TEST_F(ImportSampling, ColumnsOfABankAreAveragedAsItsOwnDataWere) {
  options.rate_hz = 10.0;
  const auto x = [](double t) { return std::cos(91.0 * t * t); };
  read(at_100_hz, x, held);
  EXPECT_TRUE(data.recording.states[0].averaged);
  EXPECT_FALSE(data.recording.inputs[0].averaged);
  const AveragedColumns inputs_alone{{}, {0}, 0.02};
  const Trajectory run = import_data(options, nullptr, &inputs_alone).recording.runs.at(0);
  for (Index k = 0; k < run.samples(); ++k) {
    const double t = run.time_s(k);
    EXPECT_NEAR(run.state(0, k), x(t), 1e-8);
    double mean = 0.0;
    for (int i = 0; i <= 10; ++i) mean += (i == 0 || i == 10 ? 0.05 : 0.1) * held(std::max(0.0, t - 0.12 + 0.01 * i));
    EXPECT_NEAR(run.input(0, k), mean, 1e-8) << t;
  }
}

TEST_F(ImportSampling, MissingStatesMakeTheirOwnMeansMissing) {
  std::string content = "time,x,u\n";
  for (int k = 0; k < 1000; ++k)
    content +=
        fmt::format("{:.2f},{},{}\n", at_100_hz(k), k == 455 ? "" : fmt::format("{:.9f}", slow(at_100_hz(k))), 1);
  write("log.csv", content);
  options.rate_hz = 10.0;
  options.missing = Missing::predict;
  const Trajectory run = import().recording.runs.at(0);
  for (Index k = 0; k < run.samples(); ++k) EXPECT_EQ(std::isnan(run.state(0, k)), k == 45) << k;
}

/// Times with a mean step of 0.2 s. The steps are alternately longer and shorter by `share`.
std::function<double(int)> alternating(double share) {
  return [share](int k) { return 0.2 * k + (k % 2 == 0 ? 0.0 : 0.2 * share); };
}

TEST_F(ImportSampling, EvenStepsKeepTheirTimes) {
  const Trajectory run = read(alternating(0.05), slow, held);
  EXPECT_NEAR(run.time_s(1) - run.time_s(0), 0.2 * 1.05, 1e-9);
  EXPECT_THAT(data.notes, IsEmpty());
}

/// If the rate is near the log's rate, uneven steps stay uneven. Only the sum of many steps is an even step.
TEST_F(ImportSampling, StepsThatScatterAreKeptAndSaid) {
  const auto uneven = alternating(0.2);  // steps are alternately 0.24 and 0.16 s; the median is one of these
  for (const double rate_hz : {0.0, 5.0, 1.25}) {
    options.rate_hz = rate_hz;
    const Trajectory run = read(uneven, slow, held);
    if (rate_hz == 0.0) {
      EXPECT_NEAR(run.time_s(1) - run.time_s(0), 0.24, 1e-9);
    }
    EXPECT_GT(data.step_scatter, 0.1) << rate_hz;
    EXPECT_THAT(data.notes, Contains(HasSubstr("modes are not judged"))) << rate_hz;
  }
  options.rate_hz = 0.1;
  read(uneven, slow, held);
  EXPECT_EQ(data.step_scatter, 0.0);
}

}  // namespace
}  // namespace modebank
