// `modebank run LOG...`: from simulated logs to a page, an archive and the configuration that repeats them.
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <sstream>

#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;

class RunLog : public CliTest {
 protected:
  std::string ini() const { return file("drive.ini").string(); }
  std::string h5() const { return file("drive.h5").string(); }
  std::string html() const { return file("drive.html").string(); }
  ProgramResult run_log(std::vector<std::string> words) const {
    words.insert(words.begin(), {"run", "--archive.output", h5()});
    return modebank(words);
  }
};

TEST_F(RunLog, RefusesFilesThatExistBeforeAnythingIsComputed) {
  write("log.csv", "time,wz,left\n");  // would also be refused, because it has no rows
  write("drive.html", "<!DOCTYPE html>a page");
  write("drive.ini", "[data]\nstate = x\n");
  const ProgramResult result = run_log({file("log.csv").string()});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr(ini() + ", " + html() + " exist: replace with --force"));
  EXPECT_EQ(read_file(ini()), "[data]\nstate = x\n");
  write("log.csv", csv_run(300, 3));
  EXPECT_EQ(run_log({file("log.csv").string(), "--force"}).status, 0);
  EXPECT_THAT(read_file(ini()), HasSubstr("state = wz"));
}

TEST_F(RunLog, LogsOfOneKindAreRunsAndOtherColumnsAreRefused) {
  for (const unsigned i : {1u, 2u, 3u, 4u}) write("log_" + std::to_string(i) + ".csv", csv_run(150, i));
  const auto log = [&](int i) { return file("log_" + std::to_string(i) + ".csv").string(); };
  const ProgramResult several = run_log({log(1), log(2), log(3), log(4)});
  ASSERT_EQ(several.status, 0) << several.err;
  EXPECT_THAT(several.out, HasSubstr("runs      4, one for each file"));
  EXPECT_EQ(read_archive(h5()).recording->runs.size(), 4u);
  write("tank.csv", "time,aa,bb\n0,1,2\n1,1,3\n2,2,1\n");
  const ProgramResult other = run_log({log(1), file("tank.csv").string(), "--force"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr(log(1)));
  EXPECT_THAT(other.err, HasSubstr("tank.csv have different columns"));
}

/// The pump of a tank and a gyro look like input and state, but the files were recorded at different times.
TEST_F(RunLog, TwoFilesOfOtherTimesAreNoInstrumentsOfOneRun) {
  std::string pump = "time,pump\n", gyro = "time,wz\n";
  for (int k = 0; k < 300; ++k) {
    pump += std::to_string(1000.0 + 0.1 * k) + "," + std::to_string(std::sin(0.3 * k)) + "\n";
    gyro += std::to_string(1020.0 + 0.1 * k) + "," + std::to_string(std::cos(0.7 * k)) + "\n";
  }
  write("pump.csv", pump);
  write("gyro.csv", gyro);
  const ProgramResult result = run_log({file("pump.csv").string(), file("gyro.csv").string()});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("are not two instruments of the same runs (of the shorter one's 29.9 s they have "
                                    "9.9 s in common)"));
}

/// Two instruments with clocks that differ by half a second. The configuration contains the lag and its gain. The
/// screen states what a robot must do. The states' file has twice the rate of the inputs' file.
TEST_F(RunLog, LateInputsOfAnotherInstrumentAreFoundAndNamed) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::ostringstream commands, gyro;
  commands << "time,left,right\n";
  gyro << "time,wz\n";
  double wz = 0.0, left = 0.0, right = 0.0;
  for (int k = 0; k < 3000; ++k) {
    if (k % 20 == 0) left = uniform(generator), right = uniform(generator);
    if (k % 2 == 0) commands << 0.05 * k + 0.5 << ',' << left << ',' << right << '\n';
    gyro << 0.05 * k << ',' << wz + 0.002 * uniform(generator) << '\n';
    wz += 0.2 * (right - left - wz);
  }
  write("wheels.csv", commands.str());
  write("gyro.csv", gyro.str());
  const ProgramResult result = run_log({file("wheels.csv").string(), file("gyro.csv").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive archive = read_archive(h5());
  ASSERT_TRUE(archive.lag);
  EXPECT_NEAR(archive.lag->lag.mean, -0.5, 0.1);  // the tolerance is a period of the inputs
  EXPECT_THAT(read_file(ini()), ::testing::ContainsRegex("\nlag_s = auto +# inputs act -0\\.[45]"));
  EXPECT_THAT(result.out, HasSubstr("the stamps of the inputs are 0."));
  for (const char* label : {"time ", "state ", "inputs ", "runs ", "read ", "files "})
    EXPECT_THAT(result.out, HasSubstr(std::string("\n") + label));
  EXPECT_THAT(read_file(ini()), HasSubstr("are taken for two instruments of one run: they have 149."));
}

TEST_F(RunLog, KeysOfTheCommandLineAreWrittenAndThoseOfTheLogsRefused) {
  write("log.csv", csv_run(300, 3));
  const std::string log = file("log.csv").string();
  ASSERT_EQ(run_log({log, "--data.input", "left", "--job.seed", "7"}).status, 0);
  EXPECT_THAT(read_file(ini()), HasSubstr("input = left "));
  EXPECT_THAT(read_file(ini()), HasSubstr("seed = 7"));
  const ProgramResult refused = run_log({log, "--force", "--data.inputs", "other.csv"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--data.inputs"));
}

}  // namespace
}  // namespace modebank::test
