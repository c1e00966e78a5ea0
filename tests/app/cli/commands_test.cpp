#include <fmt/format.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>

#include "app/cli/command_table.hpp"
#include "app/text/terminal.hpp"
#include "app/text/warnings.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

class Commands : public CliTest {};

TEST_F(Commands, RunWritesACompleteArchiveAndASummary) {
  const ProgramResult result = run();
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part : {"read  ", "finding  ", "wz per left", "band  ", "mean  ", "next  ", "archive  "})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  const std::string shown = modebank({"show", archive()}).out;
  for (const char* part : {"windows", "mixture", "baseline", "noise_only", "one_motion", "drifting", "modes of motion",
                           "wz <- wz = ", "wz <- right", "modes in words"})
    EXPECT_NE(shown.find(part), std::string::npos) << part;
  EXPECT_EQ(left_behind(), std::vector<std::string>{"out.h5"});
  EXPECT_EQ(modebank({"verify", archive()}).status, 0);
}

TEST_F(Commands, ResidualTestsAreInTheArchiveAndInTheSummary) {
  const ProgramResult result = run();
  ASSERT_EQ(result.status, 0) << result.err;
  std::map<std::string, int> lags;
  for (const char* name : {"00", "01"}) {
    const nlohmann::json rows = inspect(archive(), "/residual_tests/lags", name).at("value");
    for (const nlohmann::json& row : rows) {
      EXPECT_EQ(row.at("autocorrelation").size(), 1u);
      EXPECT_EQ(row.at("cross_correlation").size(), 2u);
      ++lags[row.at("model").get<std::string>() + " " + name];
    }
  }
  for (const std::string model : {"global", "bank", "baseline", "noise_only", "one_motion", "drifting"})
    for (const std::string name : {"00", "01"}) EXPECT_EQ(lags[model + " " + name], 26) << model << " " << name;
  const ProgramResult shown = modebank({"show", archive()});
  EXPECT_NE(shown.out.find("residuals global"), std::string::npos) << shown.out;
  EXPECT_NE(shown.out.find("% of input correlations (train / test)"), std::string::npos) << shown.out;
  EXPECT_NE(shown.out.find("R^2 of the increments"), std::string::npos) << shown.out;
}

/// The loss is the difference of the scores in the summary, even if lags leave some samples without a score.
TEST_F(Commands, MergingModesSaysWhatItCostsInTheSummarysScores) {
  std::vector<std::string> options{"--window.model", "varx", "--window.state_lags", "3", "--mixture.components", "3"};
  const auto pooled = [&](Role role) {
    for (const SummaryRow& row : read_archive(archive()).summary)
      if (row.filter == "bank" && row.role == role && row.run == "*") return row;
    return SummaryRow();
  };
  ASSERT_EQ(run(options).status, 0);
  EXPECT_TRUE(read_archive(archive()).merging.empty());
  const SummaryRow before[]{pooled(Role::train), pooled(Role::test)};
  options.insert(options.end(), {"--bank.modes", "1"});
  const ProgramResult result = run(options);
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<MergingCost> merging = read_archive(archive()).merging;
  ASSERT_EQ(merging.size(), 2u);
  for (const std::size_t i : {0u, 1u}) {
    const SummaryRow after = pooled(i == 0 ? Role::train : Role::test);
    EXPECT_EQ(merging[i].role, after.role);
    EXPECT_EQ(merging[i].components, 3);
    EXPECT_EQ(merging[i].modes, 1);
    EXPECT_EQ(merging[i].samples, after.samples);
    EXPECT_NEAR(merging[i].log_score_unlimited, before[i].log_score, 1e-10);
    EXPECT_NEAR(merging[i].log_score, after.log_score, 1e-10);
    EXPECT_NEAR(merging[i].loss, before[i].log_score - after.log_score, 1e-10);
  }
  const std::string cost = fmt::format("a loss of {:.4f}", before[1].log_score - pooled(Role::test).log_score);
  const std::string shown = modebank({"show", archive()}).out;
  EXPECT_NE(shown.find("merged    3 components into 1 modes: log score on held-out runs"), std::string::npos);
  EXPECT_NE(shown.find(cost), std::string::npos) << cost << '\n' << shown;
}

/// The gyro sometimes reads 1e15. All columns must stay aligned.
TEST_F(Commands, HugeNumbersStayInTheirColumns) {
  std::string text = csv_run(80, 1);
  for (const double share : {0.3, 0.6}) {
    const std::size_t row = text.find("\n", static_cast<std::size_t>(share * static_cast<double>(text.size()))) + 1;
    const std::size_t state = text.find(',', row) + 1;
    text.replace(state, text.find(',', state) - state, "1e15");
  }
  write("run_01.csv", text);
  const ProgramResult result = run({"--filter.horizon", "1,3"});
  ASSERT_EQ(result.status, 0) << result.err;
  const ProgramResult shown = modebank({"show", archive()});
  std::istringstream lines(result.out + shown.out);
  for (std::string line; std::getline(lines, line);)
    if (line.find("archive") != 0 && line.find(file("").string()) == std::string::npos) {
      EXPECT_LE(app::columns_of(line), 220) << line;
    }
  EXPECT_EQ(result.out.find("00000000000"), std::string::npos) << result.out;
}

/// A column of zeros and ones has the same effect as removing transitions. An invalid weight is refused.
TEST_F(Commands, SampleWeightsComeFromAColumn) {
  std::string text = csv_run(80, 1), weighted = "time,wz,left,right,w\n";
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  for (int k = 0; std::getline(lines, line); ++k) weighted += line + (k % 9 == 4 ? ",0\n" : ",3\n");
  write("run_00.csv", weighted);
  write("run_01.csv", weighted);
  ASSERT_EQ(run({"--data.weight", "w"}).status, 0);
  const Archive archived = read_archive(archive());
  EXPECT_EQ(archived.recording->runs[0].weight(4), 0.0);
  EXPECT_EQ(archived.windows->global.transitions, 79 - 9);
  EXPECT_EQ(archived.windows->transitions(0), 25 - 3);
  const ProgramResult negative = run({"--data.weight", "left"});
  EXPECT_EQ(negative.status, 1);
  EXPECT_NE(negative.err.find("run_00.csv:"), std::string::npos) << negative.err;
}

TEST_F(Commands, AHorizonThatNoRunReachesIsAnError) {
  const ProgramResult result = run({"--filter.horizon", "1,5000"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("filter.horizon = 5000 is too long for the held-out runs"), std::string::npos)
      << result.err;
  EXPECT_TRUE(left_behind().empty());
}

/// Data without noise: y[k+1] = 0.9 y[k] + 0.2 u[k], with all digits.
TEST_F(Commands, DataWithoutNoiseEndInCoefficients) {
  for (const char* name : {"run_00.csv", "run_01.csv"}) {
    std::string text = "time,y,u\n";
    double y = 0.3;
    for (int k = 0; k < 300; ++k) {
      const double u = std::sin(1.0 + k / 7 * (name[5] - '0' + 3.0));
      text += fmt::format("{:.17g},{:.17g},{:.17g}\n", 0.1 * k, y, u);
      y = 0.9 * y + 0.2 * u;
    }
    write(name, text);
  }
  write("exact.ini",
        "[data]\ninputs = run_*.csv\nstate = y\ninput = u\n[archive]\noutput = " + file("exact.h5").string() + "\n");
  const ProgramResult result = modebank({"run", file("exact.ini").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string screen = std::regex_replace(result.out, std::regex("\n +"), " ");
  for (const char* said : {"up to rounding", "y <- y -0.1, y <- u 0.2", "write the coefficients"})
    EXPECT_NE(screen.find(said), std::string::npos) << said << '\n' << screen;
}

/// A first-order lag of 1 s with gain 2, discretised exactly for steps of 0.05 to 0.35 s. An earlier version found four
/// modes in these data.
TEST_F(Commands, StepsThatScatterEndInOneModelAndItsTimeConstant) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  boost::random::normal_distribution<double> normal;
  for (int run = 0; run < 8; ++run) {
    std::string text = "time,y,u\n";
    double t = 0.0, y = 0.0, u = 0.0;
    for (int k = 0; k < 400; ++k) {
      text += fmt::format("{:.6f},{:.6f},{:.4f}\n", t, y, u);
      const double dt = 0.05 + 0.3 * uniform(generator), a = std::exp(-dt);
      y = a * y + 2.0 * (1.0 - a) * u + 0.1 * std::sqrt((1.0 - a * a) / 2.0) * normal(generator);
      t += dt;
      if (uniform(generator) < 0.1) u = 2.0 * uniform(generator) - 1.0;
    }
    write(fmt::format("log_{}.csv", run), text);
  }
  write("uneven.ini",
        "[data]\ninputs = log_*.csv\nstate = y\ninput = u\n[archive]\noutput = " + file("uneven.h5").string() + "\n");
  const ProgramResult result = modebank({"run", file("uneven.ini").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("not judged yet: time steps scatter by 4"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("warning"), std::string::npos) << result.out;
  const Archive archived = read_archive(file("uneven.h5"));
  EXPECT_EQ(archived.finding->answer, Answer::not_yet);
  ASSERT_EQ(archived.bank->mode_count(), 1);
  EXPECT_NEAR(-archived.recording->median_period_s() / std::log1p(archived.bank->theta(0)(0)), 1.0, 0.1);
}

/// The import refuses values whose square is too large for a double. So the test makes such values itself.
TEST(WindowWarnings, NameWindowsWithoutAFiniteFit) {
  app::WindowCounts counts;
  counts.status[static_cast<std::size_t>(FitStatus::converged)] = 5;
  EXPECT_TRUE(app::window_warnings({}, counts).empty());
  counts.status[static_cast<std::size_t>(FitStatus::failed)] = 3;
  const std::vector<app::Warning> warnings = app::window_warnings({}, counts);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].kind, app::WarningKind::failed_windows);
  EXPECT_NE(warnings[0].text.find("3 of 8 windows have no finite fit"), std::string::npos) << warnings[0].text;
}

TEST_F(Commands, ShowBeginsWithTheSameScreenAndPrintsAnyObject) {
  const ProgramResult result = run();
  ASSERT_EQ(result.status, 0) << result.err;
  const ProgramResult shown = modebank({"show", archive()});
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(shown.out.substr(0, result.out.size()), result.out);
  for (const char* part : {"candidates", "modes", "config", "<- selected"})
    EXPECT_NE(shown.out.find(part), std::string::npos);
  const ProgramResult object = modebank({"show", archive(), "bank/A", "--json"});
  ASSERT_EQ(object.status, 0) << object.err;
  const Archive content = read_archive(archive());
  const double A = content.bank->modes[0].model.A(0, 0);
  EXPECT_EQ(nlohmann::json::parse(object.out).at("value")[0][0][0].get<double>(), A);
  const ProgramResult full = modebank({"show", archive(), "bank/A", "--json", "--form", "full"});
  EXPECT_EQ(nlohmann::json::parse(full.out).at("value")[0][0][0].get<double>(), 1.0 + A);
  EXPECT_EQ(modebank({"show", archive(), "bank/nothing"}).status, 2);
}

TEST_F(Commands, OptionsMayBeGivenWithEqualSignAndMayBeEmpty) {
  write("test.ini", std::string(config_text()) + "[bank]\nmeasurement_variance = 0.25\n");
  ASSERT_EQ(run({"--mixture.components=1"}).status, 0);
  EXPECT_EQ(read_archive(archive()).bank->R(0, 0), 0.25);
  for (const std::vector<std::string>& empty :
       {std::vector<std::string>{"--bank.measurement_variance="}, {"--bank.measurement_variance", ""}}) {
    ASSERT_EQ(run(empty).status, 0);
    EXPECT_LT(read_archive(archive()).bank->R(0, 0), 0.25);
  }
}

TEST_F(Commands, ThePapersOwnLayoutRunsByChangingDataOptionsOnly) {
  for (const char* run : {"01", "02"}) {
    std::istringstream lines(csv_run(90, static_cast<unsigned>(run[1])));
    std::string line, states = "time,IMU_fil_AngZ\n", joints = "Time,name,velocity_0,velocity_1\n";
    std::getline(lines, line);
    for (int k = 0; std::getline(lines, line); ++k) {
      std::istringstream fields(line);
      std::string time, wz, left, right;
      std::getline(fields, time, ',');
      std::getline(fields, wz, ',');
      std::getline(fields, left, ',');
      std::getline(fields, right);
      states += time + "," + wz + "\n";
      joints += std::to_string(1700000000 + k) + ",\"['front_left', 'front_right']\"," + left + "," + right + "\n";
    }
    write("TSyn_" + std::string(run) + ".csv", states);
    write("joint_states_" + std::string(run) + ".csv", joints);
  }
  const std::string husky = (project_dir() / "configs/husky_ice.ini").string();
  const ProgramResult result =
      modebank({"run", husky, "--data.root", file(".").string(), "--data.inputs", "joint_states_*.csv", "--data.states",
                "TSyn_*.csv", "--data.state", "IMU_fil_AngZ", "--data.input", "velocity_0, velocity_1", "--data.join",
                "row", "--archive.output", archive()});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive content = read_archive(archive());
  ASSERT_EQ(content.recording->runs.size(), 2u);
  EXPECT_EQ(content.recording->runs[0].samples(), 90);
  EXPECT_EQ(content.recording->runs[0].run, "01");
}

TEST_F(Commands, HelpNamesEveryCommand) {
  const ProgramResult result = modebank({"--help"});
  EXPECT_EQ(result.status, 0);
  for (const app::Command& command : app::command_table())
    EXPECT_NE(result.out.find("\n  " + command.name + " "), std::string::npos) << command.name;
}

TEST_F(Commands, HelpOfACommandShowsItsUse) {
  for (const auto& [command, part] : {std::pair{"export", "--to FORM"},
                                      {"export", "casadi"},
                                      {"track", "log.csv"},
                                      {"predict", "--horizon"},
                                      {"verify", "verify ARCHIVE"}}) {
    const ProgramResult result = modebank({"help", command});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find(part), std::string::npos) << result.out;
    EXPECT_EQ(modebank({command, "--help"}).out, result.out);
  }
}

/// A command on the screen must work in the folder of the user.
TEST_F(Commands, NextCommandsNameTheProgramAsItWasCalled) {
  const std::string path = std::getenv("PATH"), program = MODEBANK_PROGRAM;
  const std::string log = file("run_00.csv").string();
  const auto next = [&] { return modebank({"init", log, "-o", file("next.ini").string(), "--force", "--yes"}).out; };
  EXPECT_NE(next().find("next: " + program + " run "), std::string::npos);
  setenv("PATH", (std::filesystem::path(program).parent_path().string() + ":" + path).c_str(), 1);
  const std::string by_name = next();
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(by_name.find("next: modebank run "), std::string::npos) << by_name;
}

/// Each term has one definition. All names of the term lead to it. A key has its own definition.
TEST_F(Commands, HelpSaysWhatATermOrAKeyMeans) {
  const std::string definition = modebank({"help", "NIS"}).out;
  EXPECT_NE(definition.find("Normalised innovation squared"), std::string::npos) << definition;
  EXPECT_EQ(modebank({"help", "mean nis"}).out, definition);
  EXPECT_NE(modebank({"help", "window.length"}).out.find("--window.length"), std::string::npos);
  const auto unknown = modebank({"help", "wight"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("no command, section, key or term"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace modebank::test
