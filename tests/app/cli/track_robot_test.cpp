// The live filter with failures around it: full disks, logs without a reader, killed processes.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "app/cli/track_watchdog.hpp"
#include "tests/app/cli/track_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Runs the program in a shell. The shell's redirections cause the failures.
class TrackRobot : public Track {
 protected:
  ProgramResult shell(const std::string& script) const {
    return run_program({"/bin/sh", "-c", "cd '" + file("").string() + "'; M='" + MODEBANK_PROGRAM + "'; " + script});
  }
  static int lines_of(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }
  std::string checkpoint() const { return file("state.json").string(); }
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

TEST_F(TrackRobot, Finding_D6_GoesOnWhereACheckpointCannotBeWritten) {
  std::filesystem::create_directory(file("sub"));
  PipedProgram program(
      command({"--track.checkpoint", file("sub/state.json").string(), "--track.checkpoint_interval", "5"}));
  const std::vector<std::string> samples = lines("run_01.csv");
  program.write(samples[0] + "\n");
  ASSERT_TRUE(program.read_line());
  std::filesystem::rename(file("sub"), file("away"));
  for (std::size_t k = 1; k <= 20; ++k) {
    program.write(samples[k] + "\n");
    ASSERT_TRUE(program.read_line()) << k;
  }
  std::filesystem::rename(file("away"), file("sub"));
  for (std::size_t k = 21; k <= 30; ++k) {
    program.write(samples[k] + "\n");
    ASSERT_TRUE(program.read_line()) << k;
  }
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_TRUE(std::filesystem::exists(file("sub/state.json")));
  const std::string errors = program.errors();
  EXPECT_EQ(lines_of(errors), 2) << errors;
  EXPECT_THAT(errors, HasSubstr("the filter continues without it, and tries again every 5 samples"));
  EXPECT_THAT(errors, HasSubstr("is written again"));
}

/// The last checkpoint cannot be written. The program must first write all estimates and then exit with an error
/// status.
TEST_F(TrackRobot, Finding_D6_EstimatesLeaveBeforeAFailure) {
  std::filesystem::create_directory(file("sub"));
  PipedProgram program(command({"--track.checkpoint", file("sub/state.json").string()}));
  const std::vector<std::string> samples = lines("run_01.csv");
  program.write(samples[0] + "\n");
  ASSERT_TRUE(program.read_line());
  std::filesystem::rename(file("sub"), file("away"));
  for (std::size_t k = 1; k <= 20; ++k) program.write(samples[k] + "\n");
  program.close_input();
  for (std::size_t k = 1; k <= 20; ++k) EXPECT_TRUE(program.read_line()) << k;
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.errors(), HasSubstr("cannot write " + file("sub/state.json").string()));
}

/// Each kill is at another distance from the last checkpoint, and some inputs are missing. Each output is cut at the
/// sample from which the next process continues. Together the outputs must equal the output of a single process.
TEST_F(TrackRobot, WritesTheSameBitsThroughKillsAsWithoutThem) {
  std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 3; k < samples.size(); k += 7)  // removes the last field, which is an input
    samples[k].erase(samples[k].rfind(',') + 1);
  const auto feed = [&](PipedProgram& program, std::size_t first, std::size_t last, std::vector<std::string>& out) {
    program.write(samples[0] + "\n");
    program.read_line();
    for (std::size_t k = first; k < last; ++k) {
      program.write(samples[k] + "\n");
      out.push_back(program.read_line().value());
    }
  };
  std::vector<std::string> whole, parts;
  {
    PipedProgram program(command());
    feed(program, 1, samples.size(), whole);
  }
  const std::vector<std::string> keep{"--track.checkpoint", checkpoint(), "--track.checkpoint_interval", "4"};
  std::size_t next = 1;
  for (std::size_t life = 0; next < samples.size(); ++life) {
    std::vector<std::string> options = keep, out;
    if (life > 0) options.insert(options.end(), {"--track.resume", checkpoint()});
    PipedProgram program(command(options));
    const std::size_t last = std::min(samples.size(), next + 9 + 2 * life);
    feed(program, next, last, out);
    if (life > 0) {
      EXPECT_THAT(program.errors(), HasSubstr("goes on after the sample at"));
    }
    program.send_signal(SIGKILL);
    program.wait();
    // A process writes a checkpoint after every fourth sample.
    const std::size_t kept = last == samples.size() ? out.size() : out.size() / 4 * 4;
    parts.insert(parts.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(kept));
    next = last == samples.size() ? last : next + kept;
  }
  EXPECT_EQ(parts, whole);
}

TEST_F(TrackRobot, WatchdogSpeaksWhetherSamplesComeOrNot) {
  PipedProgram program(command({"--track.watchdog_s", "0.05"}));
  const std::vector<std::string> samples = lines("run_01.csv");
  for (std::size_t k = 0; k <= 5; ++k) {
    program.write(samples[k] + "\n");
    ASSERT_TRUE(program.read_line());
  }
  // Messages may also come before and between the samples.
  while (program.errors().find(" s; 5 samples in all, the last at 0.4 s; mode probabilities") == std::string::npos)
    usleep(10'000);
  EXPECT_THAT(program.errors(), HasSubstr("no input for"));
  program.close_input();
  EXPECT_EQ(program.wait(), 0);
  EXPECT_EQ(modebank({"track", archive(), "--track.watchdog_s", "-1"}).status, 2);
}

TEST(Watchdog, SaysWhatCameInItsPeriod) {
  app::Watchdog watchdog(10.0, 100.0);
  EXPECT_EQ(watchdog.due(109.0), "");
  EXPECT_DOUBLE_EQ(watchdog.remaining_s(109.0), 1.0);
  EXPECT_EQ(watchdog.due(110.0), "no input for 10 s");
  watchdog.line_arrived();
  EXPECT_EQ(watchdog.due(120.0), "no sample in the 1 lines of 10 s");
  watchdog.line_arrived();
  watchdog.took(0.5, Eigen::Vector2d(0.25, 0.75));
  watchdog.answered(0.002);
  watchdog.answered(0.001);
  EXPECT_EQ(watchdog.due(131.0),
            "1 samples in 11 s, the slowest answered after 2 ms; 1 samples in all, the last at 0.5 s; mode "
            "probabilities 0.250 0.750");
  EXPECT_EQ(watchdog.due(141.0),
            "no input for 10 s; 1 samples in all, the last at 0.5 s; mode probabilities 0.250 0.750");
  EXPECT_FALSE(app::Watchdog(0.0, 0.0).on());
  EXPECT_EQ(app::Watchdog(0.0, 0.0).due(1e9), "");
}

}  // namespace
}  // namespace modebank::test
