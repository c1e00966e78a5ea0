// Suggestions of `modebank check`. They are scored on training runs left out.
#include <array>
#include <deque>
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

}  // namespace
}  // namespace modebank::test
