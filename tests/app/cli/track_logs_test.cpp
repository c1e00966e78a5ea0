// The live filter on logs in all forms that `run` reads: stamps, dialects, derived channels, rates and lags. Expected
// values come from `run` on the same run, or from the same numbers in the simplest form.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class TrackLogs : public Track {
 protected:
  struct Row {
    double time_s, wz, left, right;
  };
  std::vector<Row> rows(const std::string& name) const {
    std::vector<Row> result;
    for (const std::string& line : lines(name))
      if (line.front() != 't')
        result.push_back({numbers(line)[0], numbers(line)[1], numbers(line)[2], numbers(line)[3]});
    return result;
  }
  /// Writes both runs again in another form.
  void rewrite(const std::string& header, const std::function<std::string(const Row&)>& line) const {
    for (const char* name : {"run_00.csv", "run_01.csv"}) {
      std::string text = header;
      for (const Row& row : rows(name)) text += line(row) + "\n";
      write(name, text);
    }
  }
  /// Writes both runs at 51.5 Hz. wz and left change at each row; right is held for five rows.
  void write_faster(const std::function<std::string(double)>& stamp) const {
    for (const char* name : {"run_00.csv", "run_01.csv"}) {
      const std::vector<Row> slow = rows(name);
      std::string text = "time,wz,left,right\n";
      for (std::size_t k = 0; k + 1 < slow.size(); ++k)
        for (int i = 0; i < 5; ++i) {
          const double t = slow[k].time_s + 0.003 + 0.0194 * i, share = 0.2 * i;
          const auto between = [&](double Row::*signal) {
            return (1.0 - share) * slow[k].*signal + share * slow[k + 1].*signal + 0.05 * std::sin(283.0 * t);
          };
          text += fmt::format("{},{},{},{}\n", stamp(t), between(&Row::wz), between(&Row::left), slow[k].right);
        }
      write(name, text);
    }
  }
  ProgramResult track(const std::string& input, const std::string& options = "") const {
    return run_program({"/bin/sh", "-c",
                        fmt::format("cd '{}' && '{}' track out.h5 {} {}", file("").string(), MODEBANK_PROGRAM, options,
                                    input.empty() ? "" : "< " + input)});
  }
  static std::vector<std::vector<double>> table(const std::string& csv) {
    std::vector<std::vector<double>> rows;
    std::istringstream text(csv);
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) rows.push_back(numbers(line));
    return rows;
  }
  /// The estimates for run 01 must equal those of `run`. The times of `track` are later by `origin_s`.
  void expect_evaluated(const ProgramResult& result, double origin_s = 0.0, double within = 1e-12) const {
    const Archive stored = read_archive(archive());
    const Trajectory& run = stored.recording->runs[1];
    const RunEvaluation& expected = stored.evaluations[0].runs[1];
    const auto said = table(result.out);
    ASSERT_EQ(std::ssize(said), run.samples()) << result.err;
    for (Index k = 0; k < run.samples(); ++k) {
      const std::vector<double>& v = said[static_cast<std::size_t>(k)];
      EXPECT_NEAR(v[0], origin_s + run.time_s(k), 1e-6);
      EXPECT_NEAR(v[5], expected.state(0, k), within) << k;
      if (k > 0) {
        EXPECT_NEAR(v[2], expected.prediction(0, k), within) << k;
      }
    }
  }
};

constexpr double day_s = 1'714'557'600.0;  // 2024-05-01T10:00:00Z

TEST_F(TrackLogs, ReadsIsoStamps) {
  rewrite("time,wz,left,right\n", [](const Row& row) {
    return fmt::format("2024-05-01T10:00:{:06.3f}Z,{},{},{}", row.time_s, row.wz, row.left, row.right);
  });
  ASSERT_EQ(run().status, 0);
  const ProgramResult result = track("run_01.csv");
  EXPECT_EQ(result.status, 0) << result.err;
  expect_evaluated(result, day_s);
  EXPECT_EQ(track("", "--data.inputs run_01.csv").out, result.out);
}

TEST_F(TrackLogs, ReadsSecondsAndNanosecondsOfTwoColumns) {
  rewrite("secs,nsecs,wz,left,right\n", [](const Row& row) {
    const auto ns = std::llround(row.time_s * 1e9);
    return fmt::format("{},{},{},{},{}", 1'700'000'000 + ns / 1'000'000'000, ns % 1'000'000'000, row.wz, row.left,
                       row.right);
  });
  ASSERT_EQ(run({"--data.time", "secs, nsecs"}).status, 0);
  const ProgramResult result = track("run_01.csv");
  expect_evaluated(result, 1.7e9);
  EXPECT_EQ(result.err, "");
}

TEST_F(TrackLogs, ReadsSemicolonsDecimalCommasUnitsAndNoHeader) {
  const auto german = [](std::string text) {
    for (char& c : text) c = c == ',' ? ';' : c == '.' ? ',' : c;
    return text;
  };
  const auto line = [](const Row& row) { return fmt::format("{},{},{},{}", row.time_s, row.wz, row.left, row.right); };
  rewrite("time;wz;left;right\ns;rad/s;m/s;m/s\n", [&](const Row& row) { return german(line(row)); });
  ASSERT_EQ(run().status, 0);
  const ProgramResult semicolons = track("run_01.csv");
  expect_evaluated(semicolons);
  EXPECT_THAT(semicolons.err,
              AllOf(HasSubstr("separated by semicolons"), Not(HasSubstr("times more")), Not(HasSubstr("time more"))))
      << "what was found out is said once";
  for (const char* name : {"run_00.csv", "run_01.csv"}) {
    std::string text = read_file(file(name));
    text.erase(0, text.find('\n', text.find('\n') + 1) + 1);
    write(name, text);
  }
  ASSERT_EQ(run({"--data.time", "c1", "--data.state", "c2", "--data.input", "c3, c4"}).status, 0);
  const ProgramResult result = track("run_01.csv");
  expect_evaluated(result);
  EXPECT_THAT(result.err, HasSubstr("without a header (columns c1 to c4)"));
}

/// `diff` and `unwrap` need the previous row, which may belong to an earlier batch of lines.
TEST_F(TrackLogs, DerivesChannelsRowByRow) {
  double heading = 0.0;
  rewrite("time,heading_deg,left,right\n", [&](const Row& row) {
    const std::string line =
        fmt::format("{},{},{},{}", row.time_s, std::remainder(heading * 180.0 / M_PI, 360.0), row.left, row.right);
    heading += 20.0 * row.wz;
    return line;
  });
  ASSERT_EQ(run({"--data.derive", "heading = unwrap(rad(heading_deg))", "--data.derive", "turn = diff(heading)",
                 "--data.state", "turn"})
                .status,
            0);
  const Archive stored = read_archive(archive());
  const RunEvaluation& expected = stored.evaluations[0].runs[1];
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("run_01.csv");
  program.write(samples[0] + "\n");
  ASSERT_TRUE(program.read_line());
  for (std::size_t k = 1; k < samples.size(); ++k) {
    program.write(samples[k] + "\n");
    const std::vector<double> v = numbers(program.read_line().value());
    const auto i = static_cast<Index>(k - 1);
    if (k < 20) continue;  // in a live stream the first row has no slope, so the filter starts later
    EXPECT_NEAR(v[2], expected.prediction(0, i), 1e-6) << k;
  }
  // If the stream has a column with the channel's name, this column is used.
  const ProgramResult direct =
      run_program({"/bin/sh", "-c",
                   fmt::format("printf 'time,turn,left,right\\n0,0.5,0,0\\n0.1,0.4,0,0\\n' | '{}' track '{}'",
                               MODEBANK_PROGRAM, archive())});
  EXPECT_EQ(table(direct.out).at(0)[5], 0.5) << direct.err;
}

TEST_F(TrackLogs, BringsAFasterLogToTheArchivesRate) {
  write_faster([](double time_s) { return fmt::format("{}", time_s); });
  for (const char* lag_s : {"0", "0.17", "-0.23"}) {
    const ProgramResult made = run({"--data.rate_hz", "10", "--data.lag_s", lag_s});
    ASSERT_EQ(made.status, 0);
    EXPECT_THAT(made.err, HasSubstr("wz, left are the mean over the step")) << made.out;
    const ProgramResult result = track("run_01.csv");
    expect_evaluated(result, 0.0, 1e-9);
    EXPECT_EQ(track("", "--data.inputs run_01.csv").out, result.out);
  }
}

/// Doubles of seconds since 1970 would shift the ends of each step by up to 0.1 us.
TEST_F(TrackLogs, BringsDatesToTheArchivesRate) {
  write_faster([](double time_s) { return fmt::format("2024-05-01T10:00:{:09.6f}Z", time_s); });
  ASSERT_EQ(run({"--data.rate_hz", "10"}).status, 0);
  expect_evaluated(track("run_01.csv"), day_s + 0.003, 1e-9);  // time of the first row
}

/// In the new log all columns are held. In the archive's log, wz and left changed at every row.
TEST_F(TrackLogs, AveragesWhatWasAveragedForTheArchive) {
  const std::vector<Row> slow = rows("run_01.csv");
  for (const char* name : {"run_00.csv", "run_01.csv"}) {
    std::string text = "time,wz,left,right\n";
    const std::vector<Row> own = rows(name);
    for (std::size_t k = 0; k + 1 < own.size(); ++k)
      for (int i = 0; i < 5; ++i)
        text += fmt::format("{},{},{},{}\n", own[k].time_s + 0.02 * i, own[k].wz + 0.1 * std::sin(1.0 + i),
                            own[k].left + 0.1 * std::sin(2.0 + i), own[k].right);
    write(name, text);
  }
  ASSERT_EQ(run({"--data.rate_hz", "10"}).status, 0);
  std::string text = "time,wz,left,right\n";
  for (std::size_t k = 0; k + 1 < slow.size(); ++k)
    for (int i = 0; i < 5; ++i)
      text += fmt::format("{},{},{},{}\n", slow[k].time_s + 0.02 * i, slow[k].wz, slow[k].left, slow[k].right);
  write("held.csv", text);
  const ProgramResult live = track("held.csv"), read = track("", "--data.inputs held.csv");
  EXPECT_EQ(live.out, read.out) << live.err;
  EXPECT_THAT(read.err, HasSubstr("wz, left are the mean over the step"));
}

TEST_F(TrackLogs, ReadsFilesAsRunDoes) {
  const ProgramResult both = track("", "--data.inputs 'run_*.csv'");
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("run,time,steps"));
  EXPECT_THAT(both.out, HasSubstr("\n00,0,0,"));
  EXPECT_THAT(both.out, HasSubstr("\n01,0,0,"));
  EXPECT_EQ(track("", "--data.inputs run_01.csv").out, track("run_01.csv").out);
  EXPECT_EQ(track("", "--data.inputs none.csv").status, 2);
  const ProgramResult ndjson = track("", "--data.inputs run_01.csv --json");
  EXPECT_EQ(nlohmann::json::parse(ndjson.out.substr(0, ndjson.out.find('\n'))).at("time"), 0.0);
}

/// One row every two hours for a week, sent in one batch of lines and then line by line.
TEST_F(TrackLogs, PassesEveryMidnight) {
  std::string text = "time,wz,left,right\n";
  std::vector<double> times_s;
  for (int hour = 11; hour < 7 * 24; hour += 2) {
    text += fmt::format("{:02}:30:00.25,0.1,0,0\n", hour % 24);
    times_s.push_back(3600.0 * hour + 1800.25);
  }
  write("week.csv", text);
  const auto at_once = table(track("week.csv").out);
  ASSERT_EQ(at_once.size(), times_s.size());
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("week.csv");
  program.write(samples[0] + "\n");
  ASSERT_TRUE(program.read_line());
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    EXPECT_EQ(at_once[k][0], times_s[k]) << k;
    program.write(samples[k + 1] + "\n");
    EXPECT_EQ(numbers(program.read_line().value())[0], times_s[k]) << k;
  }
}

/// One whole number does not determine the unit of times, but two do.
TEST_F(TrackLogs, FindsWhatTimesCountAsTheImportDoes) {
  rewrite("time,wz,left,right\n", [](const Row& row) {
    return fmt::format("{},{},{},{}", std::llround(1000.0 * row.time_s) + 5000, row.wz, row.left, row.right);
  });
  ASSERT_EQ(run().status, 0);
  const ProgramResult whole = track("run_01.csv");
  const auto expected = table(whole.out);
  EXPECT_NEAR(expected[1][0] - expected[0][0], 0.1, 1e-9);
  PipedProgram program(command());
  const std::vector<std::string> samples = lines("run_01.csv");
  program.write(samples[0] + "\n");
  program.read_line();
  for (std::size_t k = 1; k < 20; ++k) {
    program.write(samples[k] + "\n");
    const std::vector<double> v = numbers(program.read_line().value());
    EXPECT_EQ(v[1], k == 1 ? 0 : 1) << k;
    EXPECT_EQ(v[5], expected[k - 1][5]) << k;
  }
}

}  // namespace
}  // namespace modebank::test
