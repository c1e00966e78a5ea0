// Suggestions of `modebank check`. They are scored on training runs left out, and --apply writes them.
#include <array>
#include <deque>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/app/cli/check/check_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class Suggest : public Check {
 protected:
  /// Twelve runs of 160 samples with one motion; every second run trains. `gross`: share of samples with an error of 1.
  /// `late`: number of samples between an input's row and its effect.
  Suggest() { write_runs(0.0); }

  void write_runs(double gross, int late = 0) {
    for (unsigned run = 0; run < 12; ++run) {
      std::mt19937_64 generator(run + 1);
      std::normal_distribution<double> normal;
      std::uniform_real_distribution<double> uniform(-0.5, 0.5);
      std::ostringstream text;
      text.precision(17);
      text << "time,wz,left,right\n";
      double wz = 0.0;
      std::deque<std::array<double, 2>> inputs(static_cast<std::size_t>(late), {0.0, 0.0});
      for (int k = 0; k < 160; ++k) {
        inputs.push_back({uniform(generator), uniform(generator)});
        const double error = uniform(generator) + 0.5 < gross ? (uniform(generator) > 0.0 ? 1.0 : -1.0) : 0.0;
        text << 0.1 * k << ',' << wz + error << ',' << inputs.back()[0] << ',' << inputs.back()[1] << '\n';
        wz += -0.2 * wz - 0.2 * inputs.front()[0] + 0.2 * inputs.front()[1] + 0.01 * normal(generator);
        inputs.pop_front();
      }
      write("run_" + std::string(run < 10 ? "0" : "") + std::to_string(run) + ".csv", text.str());
    }
  }
  /// A Kalman filter with known noise, for runs with gross errors of mean square 0.05. The true theta predicts best.
  /// The filter's theta is the mean over the windows. The loss determines how far the errors change this mean.
  void write_config(const std::string& more) const {
    write("test.ini",
          "[data]\n# the robot's\ninputs = run_*.csv\nstate = wz\ninput = left, right  # wheels\n[mixture]\ncomponents "
          "= 1\n"
          "[bank]\ntheta = mean\nnoise = fixed\nprocess_variance = 1e-4\nmeasurement_variance = 0.05\n" +
              more);
  }
  static std::string content(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
};

/// Without a column of times the configuration states the rate, so no other rate is tried.
TEST_F(Suggest, WithoutTimesTheRateIsNoChoice) {
  write_config("[data]\ntime =\nrate_hz = 10\n");
  const json said = check_json(config()).at("suggestions");
  EXPECT_EQ(said.at("training_runs"), 6);
  for (const json& trial : said.at("trials")) EXPECT_FALSE(trial.at("keys").contains("data.rate_hz")) << trial.dump(1);
}

TEST_F(Suggest, ARobustLossWhereErrorsAreGross) {
  write_runs(0.05);
  write_config("[window]\nloss = trivial\n");
  const json said = check_json(config()).at("suggestions");
  EXPECT_EQ(said.at("suggested").at("window.loss"), "tukey") << said.dump(1);
  EXPECT_EQ(said.at("training_runs"), 6);
  for (const json& trial : said.at("trials")) {
    const bool gains = trial.at("gain").get<double>() > trial.at("standard_error").get<double>();
    EXPECT_EQ(trial.at("accepted").get<bool>(), gains);
  }
  EXPECT_GT(said.at("together").at("gain").get<double>(), said.at("together").at("standard_error").get<double>());
}

TEST_F(Suggest, TheLagWhereInputsAreLate) {
  write_runs(0.0, 4);
  write("test.ini", std::string(config_text()) + "[window]\nloss = trivial\n");
  const json said = check_json(config()).at("suggestions");
  EXPECT_EQ(said.at("suggested").at("data.lag_s"), "auto") << said.dump(1);
  EXPECT_GT(said.at("together").at("gain").get<double>(), 0.5) << "sd 0.01 instead of 0.08: a gain of ln 8 at most";
}

TEST_F(Suggest, NothingWhereTheSettingsAreRight) {
  write_config("[window]\nloss = trivial\n");
  const json said = check_json(config()).at("suggestions");
  EXPECT_EQ(said.at("suggested"), json::object()) << said.dump(1);
  EXPECT_TRUE(said.at("together").is_null());
  const ProgramResult page = modebank({"check", config()});
  EXPECT_THAT(page.out, HasSubstr("nothing, because no other setting gains"));
}

TEST_F(Suggest, HeldOutRunsHaveNoSay) {
  write_runs(0.05);
  write_config("[window]\nloss = trivial\n");
  const json before = check_json(config());
  for (int run = 1; run < 12; run += 2)  // overwrites every held-out run
    write("run_" + std::string(run < 10 ? "0" : "") + std::to_string(run) + ".csv", csv_run(100, 99));
  const json after = check_json(config());
  EXPECT_EQ(before.at("suggestions"), after.at("suggestions"));
  EXPECT_EQ(before.at("advice"), after.at("advice"));
}

TEST_F(Suggest, TheSameForAnyNumberOfThreads) {
  write_runs(0.05);
  write_config("[window]\nloss = trivial\n");
  EXPECT_EQ(check_json(config(), {"--job.threads", "1"}), check_json(config(), {"--job.threads", "4"}));
}

TEST_F(Suggest, AppliedFileIsTheFileWithTheKeys) {
  write_runs(0.05);
  write_config("[window]\nloss = trivial  # mine\n");
  std::filesystem::create_directory(file("elsewhere"));
  const std::string applied = file("elsewhere/applied.ini").string();
  const ProgramResult result = modebank({"check", config(), "--apply", "-o", applied, "--window.step", "2"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string text = content(applied);
  for (const char* part : {"# the robot's\n", "right  # wheels\n", "# was: loss = trivial  # mine\n", "nats per sample",
                           "\nloss = tukey\n", "\nstep = 2\n"})
    EXPECT_THAT(text, HasSubstr(part));
  ASSERT_EQ(modebank({"run", applied, "--archive.output", archive()}).status, 0) << "data are found from there";
  const std::string other = file("other.h5").string();
  const json keys = check_json(config(), {"--window.step", "2"}).at("suggestions").at("suggested");
  std::vector<std::string> same{"run", config(), "--archive.output", other, "--window.step", "2"};
  for (const auto& [key, value] : keys.items()) same.insert(same.end(), {"--" + key, value.get<std::string>()});
  ASSERT_EQ(modebank(same).status, 0);
  const auto scores = [&](const std::string& of) { return modebank({"show", of, "evaluation/summary", "--json"}).out; };
  EXPECT_EQ(scores(archive()), scores(other));
}

TEST_F(Suggest, AppliedFileIsTheSameWhereNothingGains) {
  write_config("[window]\nloss = trivial\n");
  const ProgramResult result = modebank({"check", config(), "--apply", "-o", file("applied.ini").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(content(file("applied.ini")), content(config()));
  EXPECT_THAT(result.out, HasSubstr("the configuration unchanged, because nothing is suggested"));
}

TEST_F(Suggest, UsageErrorsWriteNothing) {
  write_config("");
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"check", config()});
    const ProgramResult result = modebank(options);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  const std::string before = content(config());
  EXPECT_THAT(refusal({"--apply"}), HasSubstr("--apply needs a file to write"));
  EXPECT_THAT(refusal({"-o", file("x.ini").string()}), HasSubstr("with --apply only"));
  EXPECT_THAT(refusal({"--apply", "-o", config()}), HasSubstr("is read by this command"));
  EXPECT_THAT(refusal({"--apply", "-o", file("run_00.csv").string()}), HasSubstr("is read by this command"));
  EXPECT_THAT(refusal({"--apply", "-o", file("nowhere/x.ini").string()}), HasSubstr("-o: "));
  EXPECT_EQ(content(config()), before);
  EXPECT_FALSE(std::filesystem::exists(file("x.ini")));
  const ProgramResult unusable =
      modebank({"check", config(), "--apply", "-o", file("x.ini").string(), "--window.length", "900"});
  EXPECT_EQ(unusable.status, 1);
  EXPECT_FALSE(std::filesystem::exists(file("x.ini")));
}

}  // namespace
}  // namespace modebank::test
