#include <gmock/gmock.h>

#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;

class InitCommand : public CliTest {};

/// A folder stands for the logs in it. Other files in it are ignored. The configuration has the name of the folder.
TEST_F(InitCommand, AFolderStandsForTheLogsInIt) {
  const std::filesystem::path drives = file("drives");
  std::filesystem::create_directory(drives);
  for (const unsigned i : {1u, 2u, 10u}) write_file(drives / (std::to_string(i) + ".csv"), csv_run(150, i));
  write_file(drives / "README.txt", "Three drives.\n");
  write_file(drives / ".hidden.csv", "a,b\n1,2\n");
  const auto init = [&](const std::string& folder) {
    return run_program(
        {"/bin/sh", "-c", "cd '" + file("").string() + "' && '" MODEBANK_PROGRAM "' init " + folder + ""});
  };
  const ProgramResult made = init("drives");
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(read_file(file("drives.ini")), HasSubstr("inputs = *.csv"));
  EXPECT_THAT(read_file(file("drives.ini")), HasSubstr("# 3 runs; * names them: 1 to 10"));
  EXPECT_EQ(modebank({"run", file("drives.ini").string(), "--archive.output", archive(), "--dry-run"}).status, 0);
  std::filesystem::create_directory(file("empty"));
  const ProgramResult empty = init("empty");
  EXPECT_EQ(empty.status, 2);
  EXPECT_THAT(empty.err, HasSubstr("empty: a folder without logs; expected files that end in .csv"));
}

/// A name must not add lines to the configuration, and no words to the proposed commands.
TEST_F(InitCommand, NamesOfFoldersAndFilesStayWhatTheyAre) {
  const std::filesystem::path folder = file("nl\nstate = oops # \x1b[31m");
  std::filesystem::create_directory(folder);
  write_file(folder / "one.csv", csv_run(300, 1));
  const std::string ini = file("it's $(touch pwned)`touch pwned`.ini").string();
  const ProgramResult made = modebank({"init", (folder / "one.csv").string(), "-o", ini});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string text = read_file(ini);
  EXPECT_THAT(text, HasSubstr("state = wz"));
  EXPECT_EQ(text.find("\nstate = oops"), std::string::npos);
  EXPECT_EQ((made.out + text).find('\x1b'), std::string::npos);
  const ProgramResult ran = modebank({"run", ini, "--archive.output", archive()});
  EXPECT_EQ(ran.status, 0) << ran.err;
  const std::size_t next = made.out.find("next: ") + 6;
  const std::string command = made.out.substr(next, made.out.find('\n', next) - next);
  const ProgramResult pasted = run_program({"/bin/sh", "-c", "cd '" + file("").string() + "'; " + command});
  EXPECT_EQ(pasted.status, 0) << command << pasted.err;
  EXPECT_FALSE(std::filesystem::exists(file("pwned")));
}

TEST_F(InitCommand, AFileThatNoConfigurationCanNameIsRefused) {
  for (const char* name : {"a#b.csv", "a,b.csv", "a*b.csv", " a.csv", "a\nb.csv"}) {
    write(name, csv_run(50, 1));
    const ProgramResult result = modebank({"init", file(name).string(), "-o", file("x.ini").string()});
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_THAT(result.err, HasSubstr("no configuration can name it")) << name;
    EXPECT_FALSE(std::filesystem::exists(file("x.ini"))) << name;
  }
}

}  // namespace
}  // namespace modebank::test
