// Output and exit status of `modebank check`.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>
#include <sstream>

#include "tests/app/cli/check/check_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST_F(Check, PrintsAPageAndTheSameNumbersAsJson) {
  const ProgramResult page = modebank({"check", config(), "--data.root", file(".").string()});
  ASSERT_EQ(page.status, 0) << page.err;
  for (const char* part : {"data check: 2 runs", "channel", "findings"}) EXPECT_THAT(page.out, HasSubstr(part));
  const json check = check_json(config(), {"--data.root", file(".").string()});
  EXPECT_TRUE(check.at("usable").get<bool>());
  const json& run = run_of(check, "00");
  EXPECT_EQ(run.at("inputs_sampling").at("samples"), 80);
  EXPECT_NEAR(run.at("inputs_sampling").at("rate_hz").get<double>(), 10.0, 1e-6);
  for (const char* key :
       {"role", "states_sampling", "states", "inputs", "still", "longest_constant_s", "changes", "rest_s", "rest_mean",
        "rest_sd", "excitation_order", "transitions", "windows", "deficient_windows", "lag", "problem"})
    EXPECT_TRUE(run.contains(key)) << key;
  for (const char* key :
       {"missing", "least", "largest", "mean", "sd", "quantum", "levels", "repeated", "outliers", "saturated"})
    EXPECT_TRUE(run.at("inputs")[0].contains(key)) << key;
  EXPECT_EQ(left_behind(), std::vector<std::string>{}) << "nothing is written";
}

TEST_F(Check, ReadsWhatRunWouldRefuseAndSaysWhatAcceptsIt) {
  std::istringstream lines(csv_run(90, 5));
  std::string text, line;
  for (int k = 0; std::getline(lines, line); ++k) {
    if (k == 30) text += line + "\n";                                  // adds a line with a repeated time
    if (k == 50) line = line.substr(0, line.find(',')) + ",,0.1,0.1";  // removes the state from a line
    text += line + "\n";
  }
  write("run_00.csv", text);
  const std::vector<std::string> root{"--data.root", file(".").string()};
  EXPECT_EQ(run().status, 1);
  const json check = check_json(config(), root);
  const std::string findings = check.at("findings").dump();
  EXPECT_THAT(findings, HasSubstr("data.disorder = sort"));
  EXPECT_THAT(findings, HasSubstr("data.missing = gap or predict"));
  EXPECT_EQ(run_of(check, "00").at("inputs_sampling").at("repeated_times"), 1);
  EXPECT_EQ(run_of(check, "00").at("states_sampling").at("missing_samples"), 1);
  EXPECT_EQ(run({"--data.disorder", "sort", "--data.missing", "gap"}).status, 0) << "as it said";
}

/// For 60 % of the time the input is zero and the state is constant.
TEST_F(Check, RestIsNoCoarseMeasurement) {
  for (int run = 0; run < 4; ++run) {
    std::mt19937_64 generator(static_cast<unsigned>(run) + 1);
    std::normal_distribution<double> noise(0.0, 0.01);
    std::uniform_real_distribution<double> level(-1.0, 1.0);
    std::string text = "time,wz,u\n";
    double x = 0.0, u = 0.0;
    for (int k = 0; k < 400; ++k) {
      const bool rests = k % 100 < 60;
      if (rests || k % 4 == 0) u = rests ? 0.0 : level(generator);
      if (rests) x = 0.0;
      text += fmt::format("{:.1f},{:.9g},{:.6g}\n", 0.1 * k, x, u);
      x = 0.6 * x + 0.4 * u + noise(generator);
    }
    write(fmt::format("run_{:02}.csv", run), text);
  }
  write("test.ini",
        "[data]\ninputs = run_*.csv\nstate = wz\ninput = u\n[window]\nlength = 10\n[mixture]\ncomponents = 1..2\n"
        "restarts = 2\n[bank]\nrefine = none\n");
  const json check = check_json(config(), {"--data.root", file(".").string()});
  EXPECT_EQ(check.at("findings").dump().find("wz repeats"), std::string::npos);
  const ProgramResult result = run();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out.find("repeat the one before"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace modebank::test
