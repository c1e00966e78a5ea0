// The clock of the live filter: gaps, times that go back, wrong times.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;

class TrackTime : public Track {};

TEST_F(TrackTime, PredictsOverMissingMeasurementsAndGaps) {
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 0; k < 10; ++k) {
    program.write(samples[k] + "\n");
    program.read_line();
  }
  program.write("0.9,,0.1,0.1\n");
  const std::vector<double> missing = numbers(program.read_line().value());
  EXPECT_EQ(missing[1], 1);
  EXPECT_TRUE(std::isfinite(missing[2]) && missing[2] == missing[5]) << "prediction is the estimate";
  EXPECT_TRUE(std::isnan(missing[7])) << "no NIS";
  program.write("1.2,0.01,,\n");  // three periods later; the inputs are held
  EXPECT_EQ(numbers(program.read_line().value())[1], 3);
  program.write("900,0.01,0.1,0.1\n");
  const std::vector<double> fresh = numbers(program.read_line().value());
  EXPECT_EQ(fresh[1], 0);
  EXPECT_EQ(fresh[5], 0.01);
  program.write("0.5,0.02,0.1,0.1\n");  // the time goes back, as with another clock
  EXPECT_EQ(numbers(program.read_line().value())[1], 0);
  program.write("0.6,100,0.1,0.1\n");
  const std::vector<double> outlier = numbers(program.read_line().value());
  EXPECT_EQ(outlier[9], 1) << "alarm";
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.errors(), HasSubstr("898.8 s without a sample: the filter starts anew"));
  EXPECT_THAT(program.errors(), HasSubstr("time goes back from 900 s to 0.5 s"));
}

TEST_F(TrackTime, BringsAFasterLogToTheModelsRate) {
  const std::vector<std::string> samples = lines("run_01.csv");
  const auto answers = [&](int times_faster) {
    PipedProgram program(command({"--data.rate_hz", "10"}));
    program.write(samples[0] + "\n");
    program.read_line();
    std::vector<std::vector<double>> result;
    for (std::size_t k = 1; k < 30; ++k) {
      program.write(samples[k] + "\n");
      result.push_back(numbers(program.read_line().value()));
      const std::string rest = samples[k].substr(samples[k].find(','));
      for (int i = 1; i < times_faster; ++i)
        program.write(fmt::format("{}{}\n", std::stod(samples[k]) + 0.1 * i / times_faster, rest));
    }
    program.close_input();
    EXPECT_EQ(program.wait(), 0);
    EXPECT_FALSE(program.read_line()) << "none for those between";
    return result;
  };
  const auto fast = answers(10), slow = answers(1);
  for (std::size_t k = 0; k < slow.size(); ++k) EXPECT_NEAR(fast[k][5], slow[k][5], 1e-9) << k;
}

TEST_F(TrackTime, SaysThatSamplesComeTooFastForTheModel) {
  const std::vector<std::string> samples = lines("run_01.csv");
  PipedProgram program(command());
  for (const std::string& line : {samples[0], samples[1], std::string("0.01,0.1,0,0"), std::string("0.02,0.1,0,0")}) {
    program.write(line + "\n");
    ASSERT_TRUE(program.read_line());
  }
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.errors(), HasSubstr("--data.rate_hz 10"));
}

TEST_F(TrackTime, TakesJitteringSamplesWhole) {
  const std::vector<std::string> samples = lines("run_01.csv");
  PipedProgram program(command());
  program.write(samples[0] + "\n");
  program.read_line();
  const double jitter_s[] = {0.0, 0.03, -0.02, 0.04, -0.03};
  for (std::size_t k = 1; k < 30; ++k) {
    const std::string rest = samples[k].substr(samples[k].find(','));
    program.write(fmt::format("{}{}\n", std::stod(samples[k]) + jitter_s[k % 5], rest));
    EXPECT_TRUE(program.read_line()) << k;
  }
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_EQ(program.errors(), "");
}

TEST_F(TrackTime, OneTimeFarAheadCostsNoMoreThanItsOwnSample) {
  const std::vector<std::string> samples = lines("run_01.csv");
  const auto answers = [&](bool disturbed) {
    PipedProgram program(command());
    std::vector<std::string> result;
    for (std::size_t k = 0; k < 20; ++k) {
      program.write(samples[k] + "\n");
      result.push_back(program.read_line().value());
      if (!disturbed || k != 10) continue;
      program.write("1.7e9,0.01,0.1,0.1\n");
      EXPECT_EQ(numbers(program.read_line().value())[1], 0) << "a start";
    }
    program.close_input();
    EXPECT_EQ(program.wait(), 0);
    if (disturbed) {
      EXPECT_THAT(program.errors(), HasSubstr("s without a sample: the filter starts anew"));
      EXPECT_THAT(program.errors(), HasSubstr("time goes back from 1700000000 s to 1 s, which follows 0.9 s: the "
                                              "filter goes on from there"));
    }
    return result;
  };
  EXPECT_EQ(answers(true), answers(false));
}

TEST_F(TrackTime, AClockThatGoesOnFarAheadIsBelieved) {
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 0; k < 10; ++k) {
    program.write(samples[k] + "\n");
    program.read_line();
  }
  for (const char* line : {"900,0.01,0.1,0.1\n", "900.1,0.01,0.1,0.1\n"}) {
    program.write(line);
    program.read_line();
  }
  program.write("1.0,0.02,0.1,0.1\n");  // after two samples the time goes back, as with another clock
  EXPECT_EQ(numbers(program.read_line().value())[1], 0);
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.errors(), HasSubstr("time goes back from 900.1 s to 1 s: the filter starts anew"));
}

}  // namespace
}  // namespace modebank::test
