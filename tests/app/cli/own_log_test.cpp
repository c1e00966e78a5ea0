// From a typical log of a user to an archive. The log has epoch nanoseconds, semicolons, decimal commas, and names of
// grounds.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "io/import/split.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

class OwnLog : public CliTest {
 protected:
  OwnLog() {
    std::istringstream rows(csv_run(400, 3));
    std::string row, log = "stamp;wz;left;right;ground\n[ns];rad/s;m/s;m/s;\n";
    std::getline(rows, row);
    for (int k = 0; std::getline(rows, row); ++k) {
      const std::string values = row.substr(row.find(',') + 1);
      std::string line = fmt::format("{}", 1'714'557'600'000'000'000 + 100'000'000LL * k);
      for (const char c : "," + values) line += c == ',' ? ';' : c == '.' ? ',' : c;
      log += line + (k / 50 % 2 == 0 ? ";ice\n" : ";grit\n");
    }
    write("log.csv", log);
  }
};

TEST_F(OwnLog, IsReadSplitAndComparedWithItsLabels) {
  const ProgramResult result =
      run({"--data.inputs", "log.csv", "--data.time", "stamp", "--data.split", "blocks 4", "--data.label", "ground"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* said :
       {"semicolons", "decimal commas", "units in the second row", "counts nanoseconds", "log is split into 4 blocks"})
    EXPECT_NE(result.err.find(said), std::string::npos) << said << " in\n" << result.err;
  EXPECT_EQ(inspect(archive(), "/data").at("attributes").at("label_names"), nlohmann::json({"grit", "ice"}));
  const nlohmann::json block = inspect(archive(), "/data/runs", "log.b2").at("value").at(0);
  EXPECT_EQ(block.at("role"), "test");
  EXPECT_EQ(block.at("time_origin_ns"), 1'714'557'600'000'000'000);
  EXPECT_EQ(block.at("file"), file("log.csv").string());
  EXPECT_EQ(inspect(archive(), "/data/label", "log.b2").at("shape"),
            inspect(archive(), "/data/time", "log.b2").at("shape"));
  const std::string shown = modebank({"show", archive()}).out;
  EXPECT_NE(shown.find("most probable mode of each label's samples, held-out runs"), std::string::npos) << shown;
  EXPECT_EQ(modebank({"verify", archive()}).status, 0);
}

TEST_F(OwnLog, ModesAreCalledAsTheUserSaysWhereverTheyAreListed) {
  const std::vector<std::string> words{"--data.inputs",     "log.csv",
                                       "--data.time",       "stamp",
                                       "--data.split",      "blocks 4",
                                       "--data.label",      "ground",
                                       "--bank.mode_names", "glaze, snow, a, b, c, d, e, f, g, h"};
  const ProgramResult result = run(words);
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive stored = read_archive(archive());
  const auto modes = static_cast<std::size_t>(stored.bank->mode_count());
  EXPECT_NE(result.err.find(fmt::format("bank.mode_names has 10 names, but the bank has {} mode", modes)),
            std::string::npos)
      << result.err;
  ASSERT_EQ(stored.mode_names.size(), modes);
  EXPECT_EQ(stored.mode_names[0], "glaze");
  EXPECT_NE(result.out.find("0 glaze"), std::string::npos) << result.out;
  const std::string shown = modebank({"show", archive()}).out;
  EXPECT_NE(shown.find("mode 0: glaze"), std::string::npos) << "of the confusion:\n" << shown;
  EXPECT_EQ(inspect(archive(), "/bank").at("attributes").at("mode_names").at(0), "glaze");
}

TEST_F(OwnLog, AloneAndWholeProposesASplit) {
  const ProgramResult result = run({"--data.inputs", "log.csv", "--data.time", "stamp"});
  ASSERT_EQ(result.status, 0) << result.err;
  // 400 samples are too few for four blocks, each with four windows and their lags. The screen may break the line at
  // any space.
  EXPECT_TRUE(std::regex_search(result.out, std::regex("--data.split\\s+'last\\s+30\\s+%'"))) << result.out;
  EXPECT_EQ(proposed_split(399, 26), "last 30 %");
  EXPECT_EQ(proposed_split(420, 26), "blocks 4");
  EXPECT_EQ(proposed_split(4000, 26), "blocks 10");
}

}  // namespace
}  // namespace modebank::test
