// The live filter as a program with a pipe at each end.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ident/base/not_a_number.hpp"
#include "io/archive/archive.hpp"
#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::vector<std::string> header_of(const std::string& line) {
  std::vector<std::string> names;
  std::istringstream stream(line);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

TEST_F(Track, SaysLineByLineWhatEvaluateSaidOfTheSameRun) {
  const Archive archive = read_archive(this->archive());
  const RunEvaluation& expected = archive.evaluations[0].runs[1];
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("run_01.csv");
  program.write(samples[0] + "\n");
  const auto header = program.read_line();
  ASSERT_TRUE(header);
  const std::vector<std::string> names = header_of(*header);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  for (std::size_t k = 1; k < samples.size(); ++k) {
    program.write(samples[k] + "\n");
    const auto line = program.read_line();  // waits for an answer before it sends the next sample
    ASSERT_TRUE(line) << "sample " << k;
    const std::vector<double> v = numbers(*line);
    ASSERT_EQ(v.size(), names.size());
    const auto i = static_cast<Eigen::Index>(k - 1);
    EXPECT_EQ(v[column("wz")], expected.state(0, i));
    EXPECT_EQ(v[column("p0")], expected.mode_probability(0, i));
    EXPECT_EQ(v[column("steps")], i == 0 ? 0 : 1);
    if (i == 0) continue;
    EXPECT_EQ(v[column("wz_predicted")], expected.prediction(0, i));
    EXPECT_EQ(v[column("nis")], expected.nis(i));
    EXPECT_EQ(v[column("log_density")], expected.log_density(i));
    const double half = 1.959963984540054 * std::sqrt(expected.innovation_covariance(0, i));
    EXPECT_NEAR(v[column("wz_upper")], expected.prediction(0, i) + half, 1e-12);
    EXPECT_NEAR(v[column("wz_lower")], expected.prediction(0, i) - half, 1e-12);
  }
  program.close_input();
  EXPECT_FALSE(program.read_line());
  EXPECT_EQ(program.wait(), 0);
  EXPECT_EQ(program.errors(), "");
}

TEST_F(Track, SpeaksNdjson) {
  const Archive archive = read_archive(this->archive());
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 1; k < 6; ++k) {
    const std::vector<double> v = numbers(samples[k]);
    program.write(json{{"time", v[0]}, {"wz", v[1]}, {"left", v[2]}, {"right", v[3]}, {"note", "ignored"}}.dump() +
                  "\n");
    const json answer = json::parse(program.read_line().value());
    const auto i = static_cast<Eigen::Index>(k - 1);
    EXPECT_EQ(answer.at("wz").at("estimate"), archive.evaluations[0].runs[1].state(0, i));
    EXPECT_EQ(answer.at("probability").size(), static_cast<std::size_t>(archive.bank->mode_count()));
    EXPECT_EQ(answer.at("nis").is_null(), k == 1);
    EXPECT_EQ(answer.at("alarm"), false);
  }
}

/// With filter.variant = kf the filter uses the global model, not the first mode of the bank.
TEST_F(Track, AKalmanFilterIsTheGlobalModel) {
  PipedProgram kf(command({"--filter.variant", "kf"})), baseline(command({"--track.filter", "baseline"}));
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 0; k < 10; ++k)
    for (PipedProgram* program : {&kf, &baseline}) program->write(samples[k] + "\n");
  for (std::size_t k = 0; k < 10; ++k) {
    const auto line = kf.read_line();
    ASSERT_TRUE(line);
    EXPECT_EQ(line, baseline.read_line());
  }
}

/// For every kind of competitor, live estimates equal those of `evaluate`.
TEST_F(Track, CompetitorsSayWhatEvaluateSays) {
  const Archive stored = read_archive(archive());
  const std::vector<std::string> samples = lines("run_01.csv");
  for (const FilterEvaluation& evaluation : stored.evaluations) {
    PipedProgram program(command({"--track.filter", evaluation.filter}));
    program.write(samples[0] + "\n");
    const std::vector<std::string> header = header_of(program.read_line().value());
    const auto at = static_cast<std::size_t>(std::find(header.begin(), header.end(), "log_density") - header.begin());
    for (std::size_t k = 1; k < 30; ++k) {
      program.write(samples[k] + "\n");
      const double said = numbers(program.read_line().value()).at(at);
      const double expected = evaluation.runs[1].log_density(static_cast<Eigen::Index>(k - 1));
      EXPECT_EQ(std::isnan(said), std::isnan(expected)) << evaluation.filter << ", sample " << k;
      if (!std::isnan(expected)) {
        EXPECT_EQ(said, expected) << evaluation.filter << ", sample " << k;
      }
    }
  }
  EXPECT_EQ(modebank({"track", archive(), "--track.filter", "combined", "--track.checkpoint", "c.json"}).status, 2);
}

/// One step ahead, the combined filters of `track` make the predictions that `evaluate` has scored.
TEST_F(Track, CombinedFiltersAreThoseThatWereScored) {
  const Archive stored = read_archive(archive());
  const std::vector<std::string> samples = lines("run_01.csv");
  PipedProgram program(command({"--track.filter", "combined"}));
  program.write(samples[0] + "\n");
  const std::vector<std::string> header = header_of(program.read_line().value());
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  double log_density = 0.0, squares = 0.0;
  Eigen::Index scored = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    program.write(samples[k] + "\n");
    const std::vector<double> said = numbers(program.read_line().value());
    if (std::isnan(said.at(column("log_density")))) continue;
    ++scored;
    log_density += said.at(column("log_density"));
    squares += std::pow(numbers(samples[k])[1] - said.at(column("wz_predicted")), 2);
  }
  const auto row = std::find_if(stored.summary.begin(), stored.summary.end(),
                                [](const SummaryRow& r) { return r.filter == "combined" && r.run == "01"; });
  ASSERT_NE(row, stored.summary.end());
  EXPECT_EQ(scored, row->samples);
  EXPECT_NEAR(log_density / static_cast<double>(scored), row->log_score, 1e-9);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(scored)), row->rmse(0), 1e-9);
  for (const char* key : {"--track.checkpoint", "--track.resume"})
    EXPECT_EQ(modebank({"track", archive(), "--track.filter", "combined", key, "c.json"}).status, 2);
  EXPECT_EQ(modebank({"export", archive(), "--to", "json", "--track.filter", "combined"}).status, 2);
  EXPECT_EQ(modebank({"predict", archive(), "--samples", "3", "--track.filter", "combined"}).status, 0);
}

/// If no training sample was scored, all filters have equal weights.
TEST_F(Track, CombinedFiltersStartEquallyWhereTrainingScoredNothing) {
  Archive unscored = read_archive(archive());
  std::vector<std::string> filters{"combined"};
  for (CombinationRow& row : unscored.combination) {
    if (row.role != Role::train) continue;
    if (row.horizon == 1) filters.push_back(row.filter);
    row.weight = row.start = not_a_number;
  }
  write_archive(archive(), unscored);
  const std::vector<std::string> samples = lines("run_01.csv");
  std::vector<double> densities;  // densities of the first scored sample
  for (const std::string& filter : filters) {
    PipedProgram program(command({"--track.filter", filter}));
    program.write(samples[0] + "\n");
    const std::vector<std::string> header = header_of(program.read_line().value());
    const auto at = static_cast<std::size_t>(std::find(header.begin(), header.end(), "log_density") - header.begin());
    double density = not_a_number;
    for (std::size_t k = 1; std::isnan(density); ++k) {
      program.write(samples.at(k) + "\n");
      density = numbers(program.read_line().value()).at(at);
    }
    densities.push_back(density);
  }
  ASSERT_GT(densities.size(), 2U);
  double mean = 0.0;
  for (std::size_t i = 1; i < densities.size(); ++i)
    mean += std::exp(densities[i]) / static_cast<double>(densities.size() - 1);
  EXPECT_NEAR(densities[0], std::log(mean), 1e-9);
}

TEST_F(Track, AnswersMalformedLinesOnStderrAndKeepsItsState) {
  const std::vector<std::string> samples = lines("run_01.csv");
  const auto answers = [&](bool disturbed) {
    PipedProgram program(command());
    std::vector<std::string> result;
    for (std::size_t k = 0; k < 12; ++k) {
      program.write(samples[k] + "\n");
      result.push_back(program.read_line().value());
      if (disturbed && k == 5)
        program.write("0.6,abc,0,0\n0.6,0.1\n\n0.1,0.1,0,0\n,0.1,0,0\n{\"time\": 3}\n" + std::string(2'000'000, 'x') +
                      "\n");
    }
    program.close_input();
    EXPECT_EQ(program.wait(), 0);
    if (disturbed) {
      EXPECT_THAT(program.errors(), HasSubstr("line 7: column wz: \"abc\" is not a number; skipped"));
      EXPECT_THAT(program.errors(), HasSubstr("line 8: 2 fields, but the header has 4; skipped"));
      EXPECT_THAT(program.errors(), HasSubstr("line 10: time 0.1 s is not after 0.4 s; skipped"));
      EXPECT_THAT(program.errors(), HasSubstr("line 11: time is missing; skipped"));
      EXPECT_THAT(program.errors(), HasSubstr("line 13: is too long"));
    }
    return result;
  };
  EXPECT_EQ(answers(true), answers(false));
}

TEST_F(Track, TakesWhatOtherProgramsWrite) {
  const std::vector<std::string> samples = lines("run_01.csv");
  const auto answer = [&](const std::vector<std::string>& input, std::size_t answers) {
    PipedProgram program(command());
    for (const std::string& line : input) program.write(line);
    program.close_input();
    std::vector<std::string> result;
    for (std::size_t k = 0; k < answers; ++k) result.push_back(program.read_line().value_or("none"));
    EXPECT_FALSE(program.read_line());
    EXPECT_EQ(program.wait(), 0);
    const bool ended = input.back().ends_with("\n");
    EXPECT_EQ(program.errors().find("the last line has no line break") == std::string::npos, ended);
    return result;
  };
  const std::vector<double> a = numbers(samples[1]), b = numbers(samples[2]);
  const auto plain = answer({samples[0] + "\n", samples[1] + "\n", samples[2] + "\n"}, 3);
  // The file has a byte order mark, CR LF, empty lines, more columns in another order, and no newline at the end.
  const auto row = [](const std::vector<double>& v) { return fmt::format("{},x,{},{},{}", v[3], v[1], v[0], v[2]); };
  EXPECT_EQ(answer({"\xEF\xBB\xBF"
                    "right,note,\"wz\",time,left\r\n",
                    "\r\n", row(a) + "\r\n\n", row(b)},
                   3),
            plain);
  // NaN and Infinity, as Python writes them, count as missing measurements.
  const auto object = [](const std::vector<double>& v, const std::string& wz) {
    return fmt::format("{{\"time\": {}, \"note\": \"NaN\", \"wz\": {}, \"left\": {}, \"right\": {}}}\n", v[0], wz, v[2],
                       v[3]);
  };
  const std::string first = object(a, fmt::format("{}", a[1]));
  EXPECT_EQ(answer({"\xEF\xBB\xBF" + first, object(b, "NaN")}, 2), answer({first, object(b, "null")}, 2));
  EXPECT_EQ(answer({first, object(b, "-Infinity")}, 2), answer({first, object(b, "null")}, 2));
}

TEST_F(Track, EndsCleanlyWhenNobodyReadsOrASignalComes) {
  const std::vector<std::string> samples = lines("run_01.csv");
  {
    PipedProgram program(command());
    program.write(samples[0] + "\n" + samples[1] + "\n");
    program.read_line();
    program.close_output();
    program.write(samples[2] + "\n");
    EXPECT_EQ(program.wait(), 0);
  }
  for (const int signal : {SIGINT, SIGTERM}) {
    PipedProgram program(command());
    program.write(samples[0] + "\n" + samples[1] + "\n" + samples[2].substr(0, 3));
    program.read_line();
    program.read_line();
    program.send_signal(signal);
    EXPECT_EQ(program.wait(), 0);
    const std::string errors = program.errors();
    EXPECT_TRUE(errors.empty() ||
                errors == "modebank: line 3: the input was stopped inside this line, which is left out\n")
        << errors;
  }
  PipedProgram empty(command());
  empty.close_input();
  EXPECT_EQ(empty.wait(), 0);
}

TEST_F(Track, RefusesWhatDoesNotFitBeforeAnySample) {
  PipedProgram program(command());
  program.write("time,yaw,left,right\n");
  EXPECT_EQ(program.wait(), 2);
  EXPECT_THAT(program.errors(), HasSubstr("no column \"wz\"; columns: time, yaw, left, right"));
  PipedProgram ambiguous(command());
  ambiguous.write("time,wz,wz,left,right\n");
  EXPECT_EQ(ambiguous.wait(), 2);
  EXPECT_THAT(ambiguous.errors(), HasSubstr("standard input has column \"wz\" twice"));
  EXPECT_EQ(modebank({"track"}).status, 2);
  EXPECT_EQ(modebank({"track", file("none.h5").string()}).status, 2);
  EXPECT_EQ(modebank({"track", archive(), "--data.input", "left"}).status, 2);
  EXPECT_EQ(modebank({"track", archive(), "--track.watchdog_s", "-1"}).status, 2);
  EXPECT_THAT(modebank({"track", archive(), "--track.level", "0.9"}).err, HasSubstr("instead: intervals hold 95 %"));
}

}  // namespace
}  // namespace modebank::test
