// The live filter as a program with a pipe at each end.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <sstream>

#include "ident/base/not_a_number.hpp"
#include "io/archive/archive.hpp"
#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

std::vector<std::string> header_of(const std::string& line) {
  std::vector<std::string> names;
  std::istringstream stream(line);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
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

}  // namespace
}  // namespace modebank::test
