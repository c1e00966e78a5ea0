#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "app/cli/kept_stages.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;

/// A stage that takes longer than is worth a file, whose result is one number.
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
              archive.lag_counts = LagCounts{};
              archive.lag_counts->state_lags = static_cast<Index>(value);
              return archive;
            },
            [this](Archive&& archive) { value = static_cast<double>(archive.lag_counts->state_lags); }};
  }
};

class StoppedRun : public CliTest {};

/// What a process that was stopped by Ctrl-C has kept is taken by the next, for the same key alone; after that nothing
/// is left.
TEST_F(StoppedRun, GoesOnFromTheStagesItFinished) {
  const fs::path output = file("robot.h5");
  const pid_t child = fork();
  if (child == 0) {
    app::KeptStages kept(output);
    SlowStage stage;
    kept.provide(Stage::lag_counts, "key", stage.part(3));
    raise(SIGINT);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  ASSERT_EQ(left_behind(), std::vector<std::string>{".robot.h5.stages"});
  {
    app::KeptStages kept(output);
    SlowStage same, other;
    kept.provide(Stage::lag_counts, "key", same.part(5));
    EXPECT_EQ(same.computed, 0);
    EXPECT_EQ(same.value, 3.0);
    kept.provide(Stage::lag_counts, "another key", other.part(7));
    EXPECT_EQ(other.computed, 1);
    EXPECT_EQ(other.value, 7.0);
  }
  EXPECT_TRUE(left_behind().empty());
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
}

}  // namespace
}  // namespace modebank::test
