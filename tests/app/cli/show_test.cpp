#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/text/number_text.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST(NumberText, IsFixedWhereThatFits) {
  EXPECT_EQ(app::fixed_or_short(0.0348, 5), "0.03480");
  EXPECT_EQ(app::fixed_or_short(-99999.25, 1), "-99999.2");
  EXPECT_EQ(app::fixed_or_short(1e5, 3), "1e+05");
  EXPECT_EQ(app::fixed_or_short(-1.23456e15, 5), "-1.235e+15");
  EXPECT_EQ(app::fixed_or_short(std::numeric_limits<double>::quiet_NaN(), 2), "nan");
  EXPECT_EQ(app::size_list(std::vector<double>{0.5, 2e15}, 2), "0.50 2e+15");
}

class ShowCsv : public CliTest {
 protected:
  void SetUp() override { ASSERT_EQ(run().status, 0); }
  ProgramResult csv_of(const std::vector<std::string>& words) const {
    std::vector<std::string> all{"show", archive(), "--csv"};
    all.insert(all.end(), words.begin(), words.end());
    return modebank(all);
  }
};

TEST_F(ShowCsv, IsAnyTableAsItStands) {
  const ProgramResult result = csv_of({"/evaluation/summary"});
  ASSERT_EQ(result.status, 0) << result.err;
  std::istringstream lines(result.out);
  std::string header, line;
  std::getline(lines, header);
  EXPECT_EQ(header.rfind("filter,role,run,samples,log_score,rmse[0],", 0), 0u) << header;
  const json rows = inspect(archive(), "/evaluation/summary").at("value");
  for (const json& row : rows) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line.rfind(row.at("filter").get<std::string>() + "," + row.at("role").get<std::string>(), 0), 0u) << line;
  }
  EXPECT_FALSE(std::getline(lines, line));
  EXPECT_EQ(csv_of({}).status, 2);
  const ProgramResult group = csv_of({"/evaluation"});
  EXPECT_EQ(group.status, 2);
  EXPECT_THAT(group.err, HasSubstr("its members are: bank"));
}

TEST_F(ShowCsv, OfARunHasARowPerSample) {
  const Archive stored = read_archive(archive());
  const Trajectory& run = stored.recording->runs.at(1);
  const auto lines_of = [&](const std::vector<std::string>& options) {
    const ProgramResult result = csv_of(options);
    EXPECT_EQ(result.status, 0) << result.err;
    std::vector<std::string> lines;
    std::istringstream stream(result.out);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  };
  const std::vector<std::string> data = lines_of({"/data", "--run", run.run});
  ASSERT_EQ(std::ssize(data), run.samples() + 1);
  EXPECT_EQ(data.front(), "time,input[0],input[1],state[0]");
  std::istringstream first(data[1]);
  std::string cell;
  for (const double expected : {run.time_s(0), run.input(0, 0), run.input(1, 0), run.state(0, 0)}) {
    std::getline(first, cell, ',');
    EXPECT_EQ(std::stod(cell), expected);
  }
  EXPECT_EQ(std::ssize(lines_of({"/evaluation/bank", "--run", run.run})), run.samples() + 1);
  EXPECT_EQ(lines_of({"/evaluation/bank/nis", "--run", run.run}).at(0), "nis");
  for (const std::string& line : lines_of({"/evaluation/summary", "--run", run.run}))
    EXPECT_TRUE(line.starts_with("filter,") || line.find("," + run.run + ",") != std::string::npos) << line;
  EXPECT_EQ(csv_of({"/data", "--run", "none"}).status, 2);
  EXPECT_EQ(csv_of({"/bank/A", "--run", run.run}).status, 2);
}

}  // namespace
}  // namespace modebank::test
