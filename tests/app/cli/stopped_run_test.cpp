#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "app/chain/stage_store.hpp"
#include "app/cli/kept_stages.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;

const std::string stage_hash(64, 'a'), another_hash(64, 'b');

/// A stage that is slow enough to be stored. Its result is one number.
struct SlowStage {
  int computed = 0;
  double value = 0.0;

  StagePart part(double result) {
    return {[this, result] {
              std::this_thread::sleep_for(std::chrono::milliseconds(1050));
              ++computed;
              value = result;
            },
            [this] {
              Archive archive;
              archive.structure = FoundStructure{};
              archive.structure->state_lags = static_cast<Index>(value);
              return archive;
            },
            [this](Archive&& archive) { value = static_cast<double>(archive.structure->state_lags); }};
  }
};

class StoppedRun : public CliTest {
 protected:
  /// Stops a process by Ctrl-C after one stage and returns its message. `computed`: number of stages that it computed.
  std::string stopped_after(double result, int& computed) const {
    std::array<int, 2> ends{}, counts{};
    EXPECT_EQ(pipe(ends.data()) | pipe(counts.data()), 0);
    const pid_t child = fork();
    if (child == 0) {
      signal(SIGINT, SIG_DFL);  // a background process of a shell ignores SIGINT
      dup2(ends[1], STDERR_FILENO);
      app::KeptStages kept(output());
      SlowStage stage;
      kept.provide(Stage::structure, stage_hash, stage.part(result));
      const auto told = ::write(counts[1], &stage.computed, sizeof stage.computed);
      raise(told > 0 ? SIGINT : SIGKILL);
      _exit(0);
    }
    // Without this, the reads below would not end if the child writes no message.
    close(ends[1]);
    close(counts[1]);
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
    EXPECT_EQ(::read(counts[0], &computed, sizeof computed), static_cast<ssize_t>(sizeof computed));
    std::string text(1000, ' ');
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(ends[0], text.data(), text.size()))));
    for (const int end : {ends[0], counts[0]}) close(end);
    return text;
  }
  fs::path output() const { return file("robot.h5"); }
};

/// If the keys agree, the next process uses the stages that a stopped process has stored. A complete run removes them.
TEST_F(StoppedRun, GoesOnFromTheStagesItFinished) {
  int computed = -1;
  EXPECT_NE(stopped_after(3, computed).find("are kept in"), std::string::npos);
  EXPECT_EQ(computed, 1);
  ASSERT_EQ(left_behind(), std::vector<std::string>{".robot.h5.stages"});
  // The process is stopped again before it finishes another stage. The stages of the first process must still exist.
  EXPECT_NE(stopped_after(5, computed).find("are kept in"), std::string::npos);
  EXPECT_EQ(computed, 0);
  try {
    const app::KeptStages kept(output());
    throw DataError("no space left for the archive");
  } catch (const DataError&) {  // keeps the stages, too
  }
  {
    app::KeptStages kept(output());
    SlowStage same, other;
    kept.provide(Stage::structure, stage_hash, same.part(5));
    EXPECT_EQ(same.computed, 0);
    EXPECT_EQ(same.value, 3.0);
    kept.provide(Stage::structure, another_hash, other.part(7));
    EXPECT_EQ(other.computed, 1);
    EXPECT_EQ(other.value, 7.0);
  }
  EXPECT_TRUE(left_behind().empty());
}

/// The signal is ignored, as under nohup. Afterwards the signals must have their earlier handlers.
TEST_F(StoppedRun, ASignalThatIsIgnoredStaysIgnored) {
  const auto before = signal(SIGINT, SIG_IGN);
  {
    const app::KeptStages kept(output());
    EXPECT_EQ(raise(SIGINT), 0);  // without the handler, this process would end here
  }
  EXPECT_EQ(signal(SIGINT, before), SIG_IGN);
  const auto at_end = signal(SIGTERM, SIG_DFL);
  signal(SIGTERM, at_end);
  EXPECT_EQ(at_end, SIG_DFL);
}

/// Millions of windows are fitted in a second, but writing them would take seconds and a gigabyte.
TEST_F(StoppedRun, KeepsWhatTakesLongerThanItsWritingAlone) {
  app::KeptStages kept(output());
  const fs::path folder = output().parent_path() / ".robot.h5.stages";
  SlowStage stage;
  StagePart part = stage.part(3.0);
  part.writing_s = 1e6;
  kept.provide(Stage::structure, stage_hash, part);
  EXPECT_FALSE(fs::exists(folder / stage_file_name(Stage::structure, stage_hash)));
  part.writing_s = 0.5;
  kept.provide(Stage::structure, another_hash, part);
  EXPECT_TRUE(fs::exists(folder / stage_file_name(Stage::structure, another_hash)));
}

/// A folder beside the output, or a link to a folder, may belong to somebody else.
TEST_F(StoppedRun, NothingOfOthersIsRemovedOrWrittenThroughALink) {
  fs::create_directory(file("home"));
  const fs::path folder = file(".robot.h5.stages");
  const std::string stage = stage_file_name(Stage::structure, stage_hash);
  for (const std::string& name : {std::string("mine.h5"), stage}) write("home/" + name, "precious");
  fs::create_directory_symlink("home", folder);
  {
    app::KeptStages kept(output());
    SlowStage slow;
    kept.provide(Stage::structure, another_hash, slow.part(3));
    EXPECT_EQ(slow.computed, 1);
  }
  EXPECT_TRUE(fs::is_symlink(folder));
  EXPECT_EQ(std::distance(fs::directory_iterator(file("home")), fs::directory_iterator()), 2);
  fs::remove(folder);
  fs::create_directory(folder);
  for (const char* name : {"mine.h5", "windows-old.h5"}) write(".robot.h5.stages/" + std::string(name), "precious");
  fs::create_symlink("../home/" + stage, folder / stage);
  { const app::KeptStages kept(output()); }
  EXPECT_FALSE(fs::exists(fs::symlink_status(folder / stage))) << "a link of our name goes, what it leads to stays";
  for (const std::string& name :
       {std::string(".robot.h5.stages/mine.h5"), std::string(".robot.h5.stages/windows-old.h5"),
        std::string("home/mine.h5"), "home/" + stage})
    EXPECT_EQ(read_file(file(name)), "precious") << name;
}

}  // namespace
}  // namespace modebank::test
