// `modebank run LOG...`: from simulated logs to a page, an archive and the configuration that repeats them.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "app/cli/help_text.hpp"
#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/app/labels_of.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double measured_sd = 0.02;

/// Speed of a body that follows its command within two samples: v[k+1] = 0.2 v[k] + 0.8 u[k]. The measurement noise has
/// standard deviation measured_sd. In every fourth block of 40 samples the command is zero and the body rests.
std::string body_log(int samples, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::ostringstream text;
  text.precision(17);
  text << "t,speed,cmd_speed\n";
  double v = 0.0, u = 0.0;
  for (int k = 0; k < samples; ++k) {
    if (k % 40 == 0) u = k / 40 % 4 == 3 ? 0.0 : uniform(generator);
    text << 0.1 * k << ',' << v + measured_sd * normal(generator) << ',' << u << '\n';
    v = 0.2 * v + 0.8 * u + 0.002 * normal(generator);
  }
  return text.str();
}

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
  EXPECT_EQ(run_log({file("log.csv").string(), "--force", "--effort", "quick"}).status, 0);
  EXPECT_THAT(read_file(ini()), HasSubstr("state = wz"));
}

TEST_F(RunLog, LogsOfOneKindAreRunsAndOtherColumnsAreRefused) {
  for (const unsigned i : {1u, 2u, 3u, 4u}) write("log_" + std::to_string(i) + ".csv", csv_run(150, i));
  const auto log = [&](int i) { return file("log_" + std::to_string(i) + ".csv").string(); };
  const ProgramResult several = run_log({log(1), log(2), log(3), log(4), "--effort", "quick"});
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

TEST_F(RunLog, ALogWithoutDataIsRefusedInOneSentence) {
  write("empty.csv", "time,wz,left\n");
  write("still.csv", "time,wz,left\n0,1,2\n1,1,2\n2,1,2\n3,1,2\n");
  for (const char* const name : {"empty.csv", "still.csv"}) {
    const ProgramResult result = run_log({file(name).string()});
    EXPECT_NE(result.status, 0);
    EXPECT_THAT(result.err, HasSubstr(name));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(ini()));
  }
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
  const ProgramResult result = run_log({file("wheels.csv").string(), file("gyro.csv").string(), "--effort", "quick"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive archive = read_archive(h5());
  ASSERT_TRUE(archive.lag);
  EXPECT_NEAR(archive.lag->lag.mean, -0.5, 0.1);  // the tolerance is a period of the inputs
  EXPECT_THAT(read_file(ini()), ::testing::ContainsRegex("\nlag_s = auto +# inputs act -0\\.[45]"));
  EXPECT_THAT(result.out, HasSubstr("robot     the stamps of left, right are 0."));
  std::set<std::string> labels = labels_of(result.out);
  EXPECT_THAT(labels, ::testing::IsSupersetOf({"log", "time", "state", "inputs", "runs", "robot", "files"}));
  for (const std::string& label : labels)
    EXPECT_THAT(app::help_on(label), HasSubstr(label + " (a line of the screen): "));
  EXPECT_THAT(read_file(ini()), HasSubstr("are taken for two instruments of one run: they have 149."));
}

/// The variance at rest is tried as R; its true value is measured_sd^2. In the training half, the body rests for about
/// 150 samples. The variance of these has a relative standard error of sqrt(2 / 150), 12 %. The test allows three of
/// these errors.
TEST_F(RunLog, TheNoiseAtRestIsTriedAndItsGainStated) {
  write("body.csv", body_log(1600, 1));
  const ProgramResult result = run_log({file("body.csv").string(), "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json said = nlohmann::json::parse(result.out);
  std::string noise;
  for (const auto& decision : said.at("decisions"))
    if (decision.get<std::string>().starts_with("bank.measurement_variance")) noise = decision;
  ASSERT_FALSE(noise.empty()) << said.at("decisions");
  const double variance = std::stod(noise.substr(noise.find("= ") + 2));
  EXPECT_NEAR(variance / (measured_sd * measured_sd), 1.0, 0.36);
  EXPECT_THAT(noise, HasSubstr("nats per sample"));
  EXPECT_THAT(read_file(ini()), HasSubstr("at rest ("));
}

TEST_F(RunLog, EffortIsOneOfThreeWordsAndForLogs) {
  write("body.csv", body_log(600, 1));
  const std::string log = file("body.csv").string();
  const ProgramResult other = run_log({log, "--effort", "some"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("--effort some: allowed are quick"));
  const ProgramResult configured = modebank({"run", config(), "--effort", "quick"});
  EXPECT_EQ(configured.status, 2);
  EXPECT_THAT(configured.err, HasSubstr("modebank run LOG"));
  const ProgramResult quick = run_log({log, "--effort", "quick"});
  ASSERT_EQ(quick.status, 0) << quick.err;
  EXPECT_THAT(quick.err, Not(HasSubstr("tried:")));
  EXPECT_THAT(read_file(ini()), Not(HasSubstr("measurement_variance")));
  const ProgramResult thorough =
      run_log({log, "--effort", "thorough", "--force", "--mixture.restarts", "1", "--mixture.components", "1..2"});
  ASSERT_EQ(thorough.status, 0) << thorough.err;
  EXPECT_THAT(thorough.err, HasSubstr("tried:"));
  EXPECT_THAT(read_file(ini()), HasSubstr("# from the command line\nrestarts = 1"));
}

TEST_F(RunLog, KeysOfTheCommandLineAreWrittenAndThoseOfTheLogsRefused) {
  write("log.csv", csv_run(300, 3));
  const std::string log = file("log.csv").string();
  ASSERT_EQ(run_log({log, "--effort", "quick", "--data.input", "left", "--job.seed", "7"}).status, 0);
  EXPECT_THAT(read_file(ini()), HasSubstr("input = left "));
  EXPECT_THAT(read_file(ini()), HasSubstr("seed = 7"));
  const ProgramResult refused = run_log({log, "--force", "--data.inputs", "other.csv"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--data.inputs"));
}

}  // namespace
}  // namespace modebank::test
