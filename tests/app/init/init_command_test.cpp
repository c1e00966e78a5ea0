#include <gmock/gmock.h>

#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;

class InitCommand : public CliTest {};

TEST_F(InitCommand, WritesAConfigurationThatRuns) {
  write("one.csv", csv_run(300, 1));
  const std::string log = file("one.csv").string(), ini = file("one.ini").string(), archive = file("one.h5").string();
  const ProgramResult made = modebank({"init", log, "-o", ini, "--yes"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("next: modebank run " + ini));
  EXPECT_THAT(made.out, HasSubstr("wz"));
  const ProgramResult again = modebank({"init", log, "-o", ini});
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("exists: name another file (-o FILE), or overwrite it with --force"));
  EXPECT_EQ(modebank({"init", log, "-o", ini, "--force"}).status, 0);
  const ProgramResult ran = modebank({"run", ini, "--archive.output", archive});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(std::filesystem::exists(archive));
}

TEST_F(InitCommand, IsWhatRunAsksForWhenGivenALog) {
  write("one.csv", csv_run(50, 1));
  const std::string log = file("one.csv").string();
  for (const char* command : {"run", "check"}) {
    const ProgramResult result = modebank({command, log});
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr("modebank init " + log));
  }
  EXPECT_EQ(modebank({"init"}).status, 2);
}

}  // namespace
}  // namespace modebank::test
