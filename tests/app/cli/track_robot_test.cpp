// The live filter with failures around it: full disks, logs without a reader.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

/// Runs the program in a shell. The shell's redirections cause the failures.
class TrackRobot : public Track {
 protected:
  ProgramResult shell(const std::string& script) const {
    return run_program({"/bin/sh", "-c", "cd '" + file("").string() + "'; M='" + MODEBANK_PROGRAM + "'; " + script});
  }
  static int lines_of(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }
};

TEST_F(TrackRobot, Finding_D5_GoesOnWhereStandardErrorIsFullOrClosed) {
  const std::string feed = "(head -5 run_01.csv; echo garbage; sed -n 6,9p run_01.csv) | $M track out.h5 ";
  for (const char* errors : {"2>/dev/full", "2>&-"}) {
    const ProgramResult result = shell(feed + errors);
    EXPECT_EQ(result.status, 0) << errors;
    EXPECT_EQ(lines_of(result.out), 1 + 8) << errors;
  }
}

TEST_F(TrackRobot, Finding_D5_NoCommandIsAbortedByItsOwnMessage) {
  for (const char* errors : {"2>/dev/full", "2>&-", "<&- >&- 2>&-"})
    EXPECT_EQ(shell(std::string("$M run nofile.ini ") + errors).status, 2) << errors;
  // If a standard stream is closed, no file may get its number. Otherwise messages would be written into that file.
  EXPECT_EQ(shell("$M run test.ini --archive.output closed.h5 2>&-").status, 0);
  EXPECT_EQ(shell("$M verify closed.h5").status, 0);
  EXPECT_EQ(shell("$M show out.h5 >&-").status, 1) << "nobody got the text";
}

/// The reader of the log has stopped reading, so the pipe is full. A blocking write would never return.
TEST_F(TrackRobot, GoesOnWhereNobodyReadsItsMessages) {
  std::ofstream input(file("garbage.csv"));
  const std::vector<std::string> samples = lines("run_01.csv");
  input << samples[0] << '\n';
  for (int k = 0; k < 3000; ++k) input << "this is no sample\n";
  input << samples[1] << '\n' << samples[2] << '\n';
  input.close();
  const ProgramResult result =
      shell("mkfifo log; sleep infinity < log & reader=$!; $M track out.h5 < garbage.csv 2> log; kill $reader");
  EXPECT_EQ(lines_of(result.out), 1 + 2);
}

}  // namespace
}  // namespace modebank::test
