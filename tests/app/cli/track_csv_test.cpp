// Samples as CSV lines, with quoted fields and with names that need quotes.
#include <gmock/gmock.h>

#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

TEST_F(Track, ReadsQuotedFieldsAsTheImportDoes) {
  PipedProgram plain(command()), quoted(command());
  plain.write("time,wz,left,right\n0,0.1,0.1,0.2\n0.1,0.2,0.1,0.2\n");
  quoted.write(
      "\"time\",note,\"wz\",\"left\",\"right\",\"a \"\"b\"\", c\"\n0,\"one, two\",0.1,\"0.1\",0.2,x\n"
      "0.1,\"a \"\"quote, \"\"\",0.2,0.1,0.2,\"never closed\n");
  for (PipedProgram* program : {&plain, &quoted}) program->close_input();
  for (int line = 0; line < 3; ++line) EXPECT_EQ(quoted.read_line(), plain.read_line()) << line;
  EXPECT_EQ(quoted.wait(), 0);
  EXPECT_EQ(quoted.errors(), "");
}

/// Names as Excel on Windows writes them, both in logs and in lines of samples.
TEST_F(Track, ReadsOtherBytesThanUtf8AsWindows1252) {
  for (const char* run_file : {"run_00.csv", "run_01.csv"}) {
    const std::string text = csv_run(80, run_file[5] == '0' ? 1 : 2);
    write(run_file,
          "time,gr\xF6\xDF"
          "e" +
              text.substr(std::string("time,wz").size()));
  }
  const ProgramResult made = run({"--data.state", "größe"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.err.find("read as Windows-1252"), std::string::npos) << made.err;
  PipedProgram latin(command()), utf8(command());
  latin.write(
      "{\"time\":0,\"gr\xF6\xDF"
      "e\":0.1,\"left\":0.1,\"right\":0.2}\n");
  utf8.write("{\"time\":0,\"größe\":0.1,\"left\":0.1,\"right\":0.2}\n");
  for (PipedProgram* program : {&latin, &utf8}) program->close_input();
  const std::string line = utf8.read_line().value_or("");
  EXPECT_NE(line.find("\"größe\":{"), std::string::npos) << line;
  EXPECT_EQ(latin.read_line(), line);
  EXPECT_EQ(latin.wait() + utf8.wait(), 0);
  EXPECT_NE(latin.errors().find("read as Windows-1252"), std::string::npos);
  EXPECT_EQ(utf8.errors(), "");
}

/// A CSV reader gets the original names from the header, and a spreadsheet shows them as text.
TEST_F(Track, NamesInTheHeaderAreQuoted) {
  for (const char* run_file : {"run_00.csv", "run_01.csv"}) {
    const std::string text = csv_run(80, run_file[5] == '0' ? 1 : 2);
    write(run_file, "time,\"=a\"\"b\"" + text.substr(std::string("time,wz").size()));
  }
  ASSERT_EQ(run({"--data.state", "=a\"b"}).status, 0);
  PipedProgram program(command());
  program.write("time,\"=a\"\"b\",left,right\n");
  program.close_input();
  EXPECT_THAT(
      program.read_line().value_or(""),
      testing::StartsWith("time,steps,\"'=a\"\"b_predicted\",\"'=a\"\"b_lower\",\"'=a\"\"b_upper\",\"'=a\"\"b\","));
  EXPECT_EQ(program.wait(), 0);
}

}  // namespace
}  // namespace modebank::test
