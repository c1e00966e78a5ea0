// The live filter from outside: a program between two pipes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/archive.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/support/piped_program.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Track : public CliTest {
 protected:
  void SetUp() override { ASSERT_EQ(run().status, 0); }

  std::vector<std::string> command(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{MODEBANK_PROGRAM, "track", archive()};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  /// The lines of a run's file: header, then samples.
  std::vector<std::string> lines(const std::string& name) const {
    std::ifstream stream(file(name));
    std::vector<std::string> result;
    for (std::string line; std::getline(stream, line);) result.push_back(line);
    return result;
  }

  static std::vector<double> numbers(const std::string& csv) {
    std::vector<double> values;
    std::istringstream stream(csv);
    for (std::string field; std::getline(stream, field, ',');)
      values.push_back(field.empty() ? std::nan("") : std::stod(field));
    return values;
  }
};

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
    const auto line = program.read_line();  // each answer before the next sample is sent
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
      EXPECT_THAT(program.errors(), HasSubstr("line 7: wz is not a number; skipped"));
      EXPECT_THAT(program.errors(), HasSubstr("line 8: 2 fields, the header has 4; skipped"));
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
    EXPECT_EQ(program.errors(), "");
    return result;
  };
  const std::vector<double> a = numbers(samples[1]), b = numbers(samples[2]);
  const auto plain = answer({samples[0] + "\n", samples[1] + "\n", samples[2] + "\n"}, 3);
  // A byte order mark, CR LF, empty lines, columns in another order and more of them, no newline at the end.
  const auto row = [](const std::vector<double>& v) { return fmt::format("{},x,{},{},{}", v[3], v[1], v[0], v[2]); };
  EXPECT_EQ(answer({"\xEF\xBB\xBF"
                    "right,note,\"wz\",time,left\r\n",
                    "\r\n", row(a) + "\r\n\n", row(b)},
                   3),
            plain);
  // Python's NaN and Infinity are nothing measured.
  const auto object = [](const std::vector<double>& v, const std::string& wz) {
    return fmt::format("{{\"time\": {}, \"note\": \"NaN\", \"wz\": {}, \"left\": {}, \"right\": {}}}\n", v[0], wz, v[2],
                       v[3]);
  };
  const std::string first = object(a, fmt::format("{}", a[1]));
  EXPECT_EQ(answer({"\xEF\xBB\xBF" + first, object(b, "NaN")}, 2), answer({first, object(b, "null")}, 2));
  EXPECT_EQ(answer({first, object(b, "-Infinity")}, 2), answer({first, object(b, "null")}, 2));
}

TEST_F(Track, RefusesCheckpointsThatNoFilterWrote) {
  const std::vector<std::string> samples = lines("run_01.csv");
  const std::string checkpoint = file("state.json").string();
  {
    PipedProgram program(command({"--track.checkpoint", checkpoint}));
    for (std::size_t k = 0; k < 5; ++k) program.write(samples[k] + "\n");
    program.close_input();
    EXPECT_EQ(program.wait(), 0);
  }
  std::ifstream stream(checkpoint);
  const json good = json::parse(stream);
  EXPECT_EQ(modebank({"track", archive(), "--track.resume", checkpoint}).status, 0);
  const auto resume = [&](const char* key, const json& value) {
    json bad = good;
    bad[json::json_pointer(key)] = value;
    write("bad.json", bad.dump());
    const ProgramResult result = modebank({"track", archive(), "--track.resume", file("bad.json").string()});
    EXPECT_EQ(result.status, 1) << key << result.err;
    EXPECT_THAT(result.err, HasSubstr("bad.json")) << key;
  };
  resume("/means/rows", -1);
  resume("/means/rows", 1e18);
  resume("/means/columns", json::array());
  resume("/inputs/columns/0/0", json());
  resume("/mode_probability/columns/0/0", -0.5);
  resume("/noise_scale", 0.0);
  resume("/time_s", json());
  resume("/samples", -3);
  resume("/started", "yes");
  resume("/format", "something else");
}

TEST_F(Track, PredictsOverMissingMeasurementsAndGaps) {
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
  program.write("0.5,0.02,0.1,0.1\n");  // another clock
  EXPECT_EQ(numbers(program.read_line().value())[1], 0);
  program.write("0.6,100,0.1,0.1\n");
  const std::vector<double> outlier = numbers(program.read_line().value());
  EXPECT_EQ(outlier[9], 1) << "alarm";
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.errors(), HasSubstr("898.8 s without a sample: the filter starts anew"));
  EXPECT_THAT(program.errors(), HasSubstr("time goes back from 900 s to 0.5 s"));
}

TEST_F(Track, GoesOnFromACheckpointAsIfItHadNeverStopped) {
  const std::vector<std::string> samples = lines("run_01.csv");
  std::vector<std::string> whole, parts;
  const auto feed = [&](const std::vector<std::string>& options, std::size_t first, std::size_t last, bool interrupt,
                        std::vector<std::string>& answers) {
    PipedProgram program(command(options));
    program.write(samples[0] + "\n");
    program.read_line();
    for (std::size_t k = first; k < last; ++k) {
      program.write(samples[k] + "\n");
      answers.push_back(program.read_line().value());
    }
    if (interrupt)
      program.send_signal(SIGINT);
    else
      program.close_input();
    EXPECT_EQ(program.wait(), 0) << program.errors();
  };
  const std::string checkpoint = file("state.json").string();
  feed({}, 1, 40, false, whole);
  feed({"--track.checkpoint", checkpoint}, 1, 20, true, parts);
  feed({"--track.resume", checkpoint, "--track.checkpoint", checkpoint}, 20, 30, false, parts);
  feed({"--track.resume", checkpoint}, 30, 40, false, parts);
  EXPECT_EQ(parts, whole);

  const ProgramResult other =
      modebank({"track", archive(), "--track.resume", checkpoint, "--track.filter", "baseline"});
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("is a checkpoint of another bank or of other filter settings"));
  write("half.json", "{\"format\": \"modebank checkpoint 1\"");
  EXPECT_EQ(modebank({"track", archive(), "--track.resume", file("half.json").string()}).status, 1);
  EXPECT_EQ(modebank({"track", archive(), "--track.resume", file("none.json").string()}).status, 2);
  EXPECT_EQ(modebank({"track", archive(), "--track.checkpoint", "/nowhere/state.json"}).status, 2);
}

TEST_F(Track, KeepsCheckpointsOnTheWay) {
  const std::string checkpoint = file("state.json").string();
  PipedProgram program(command({"--track.checkpoint", checkpoint, "--track.checkpoint_interval", "5"}));
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 0; k <= 6; ++k) {
    program.write(samples[k] + "\n");
    program.read_line();
  }
  EXPECT_TRUE(std::filesystem::exists(checkpoint));
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
    EXPECT_EQ(program.errors(), "");
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
  EXPECT_EQ(modebank({"track", archive(), "--track.level", "1.5"}).status, 2);
}

}  // namespace
}  // namespace modebank::test
