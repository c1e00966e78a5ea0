// The live filter as a program with a pipe at each end.

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
