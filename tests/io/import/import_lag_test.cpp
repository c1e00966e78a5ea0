#include <sstream>

#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

constexpr double lag_tolerance_s = 0.05;

/// Runs of a first-order response with commands at 10 Hz and states at 50 Hz. The commands' stamps are `early_s` too
/// early.
class ImportLag : public ImportFixture {
 protected:
  void write_runs(double early_s, int count = 4, int seconds = 60) const {
    for (int i = 0; i < count; ++i) write_delayed(std::to_string(i), early_s, 31u + static_cast<unsigned>(i), seconds);
  }

  void write_delayed(const std::string& name, double early_s, unsigned seed, int seconds) const {
    std::ostringstream inputs, states;
    inputs << "time,u\n";
    states << "time,x\n";
    std::uint64_t random = seed * 2654435761u + 1;
    double u = 0.0, x = 0.0;
    for (int step = 0; step < 50 * seconds; ++step) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      const double uniform = static_cast<double>(random >> 11) * 0x1p-53;
      if (step % 75 == 0) u = std::round((uniform - 0.5) * 50.0) / 50.0;
      if (step % 5 == 0) inputs << 0.02 * step - early_s << ',' << u << '\n';
      states << 0.02 * step << ',' << x + 0.005 * (uniform - 0.5) << '\n';
      x += (1.0 - std::exp(-0.02 / 0.25)) * (u - x);
    }
    write("pro_" + name + ".csv", inputs.str());
    write("imu_" + name + ".csv", states.str());
  }
};

TEST_F(ImportLag, AutoFindsAndUndoesIt) {
  for (const double early_s : {0.4, -0.3}) {
    write_runs(early_s);
    options.lag_auto = true;
    const ImportedData data = import();
    ASSERT_TRUE(data.lag.has_value());
    EXPECT_NE(data.lag->correction, LagCorrection::none);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(data.recording.runs[i].lag_s, early_s, lag_tolerance_s) << "inputs act that much later";
      EXPECT_EQ(data.lag->runs[i].applied_lag_s, data.recording.runs[i].lag_s);
    }
    write_runs(0.0);
    options.lag_auto = false;
    const ImportedData truth = import();
    for (std::size_t i = 0; i < 4; ++i) {
      const Trajectory &run = data.recording.runs[i], &expected = truth.recording.runs[i];
      Index same = 0, compared = 0;
      for (Index k = 0; k < run.samples(); ++k) {
        const Index j = static_cast<Index>(std::lround(run.time_s(k) * 10.0));
        if (j < 0 || j >= expected.samples() || std::abs(expected.time_s(j) - run.time_s(k)) > 1e-6) continue;
        ++compared;
        same += run.input(0, k) == expected.input(0, j) ? 1 : 0;
      }
      EXPECT_GT(compared, 550);
      EXPECT_EQ(same, compared);
    }
  }
}

TEST_F(ImportLag, ResamplingAndGapsKeepIt) {
  write_runs(0.4);
  options.lag_auto = true;
  options.rate_hz = 20.0;
  const ImportedData data = import();
  EXPECT_NEAR(data.recording.runs[0].lag_s, 0.4, lag_tolerance_s);
  EXPECT_NEAR(data.recording.median_period_s(), 0.05, 1e-9);
  EXPECT_GE(data.recording.runs[0].time_s(0), data.recording.runs[0].lag_s - 0.4 - 1e-9) << "no input, no sample";
}

TEST_F(ImportLag, WithinOneFileToo) {
  for (int i = 0; i < 4; ++i) {
    std::ostringstream text;
    text << "time,x,u\n";
    std::uint64_t random = 17u + static_cast<unsigned>(i);
    double x = 0.0;
    std::vector<double> u;
    for (int k = 0; k < 600; ++k) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      u.push_back(k % 15 == 0 ? static_cast<double>(random >> 11) * 0x1p-53 : u.back());
      const double acting = k >= 3 ? u[k - 3] : 0.0;
      text << 0.1 * k << ',' << x << ',' << u.back() << '\n';
      x += 0.3 * (acting - x);
    }
    write("one_" + std::to_string(i) + ".csv", text.str());
  }
  options.inputs = "one_*.csv";
  options.states.clear();
  options.lag_auto = true;
  const ImportedData data = import();
  EXPECT_NE(data.lag->correction, LagCorrection::none);
  for (const Trajectory& run : data.recording.runs) EXPECT_NEAR(run.lag_s, 0.3, lag_tolerance_s);
}

TEST_F(ImportLag, NeedsInputsAndTrainingRuns) {
  write_runs(0.4, 2, 20);
  options.lag_auto = true;
  options.input.clear();
  EXPECT_THAT(error<ConfigurationError>(), ::testing::HasSubstr("data.lag_s = auto needs inputs"));
}

TEST_F(ImportLag, StreamsAsTheyStand) {
  write("pro_0.csv", "time,u\n0,1\n1,2\n1,3\n0.5,\n3,4\n");
  write("imu_0.csv", "time,x\n0,1\n,2\n2,nan\n");
  const std::vector<RunStreams> runs = read_streams(options);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].inputs.stream.time_s.transpose(), row({0, 1, 1, 0.5, 3}));
  EXPECT_TRUE(std::isnan(runs[0].inputs.stream.values(0, 3)));
  EXPECT_TRUE(std::isnan(runs[0].states.stream.time_s(1)));
  EXPECT_EQ(runs[0].inputs.line[3], 5u);
}

}  // namespace
}  // namespace modebank::test
