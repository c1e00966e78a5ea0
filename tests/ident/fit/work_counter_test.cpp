#include "ident/base/work_counter.hpp"

#include <gtest/gtest.h>

namespace modebank {
namespace {

TEST(WorkCounter, TheOuterLoopIsSeenWhateverIsCountedWithin) {
  EXPECT_FALSE(WorkCounter::seen());
  {
    WorkCounter outer("windows", 100);
    for (int i = 0; i < 40; ++i) {
      WorkCounter inner("steps", 3);
      inner.add(3);
      outer.add();
    }
    const std::optional<WorkDone> seen = WorkCounter::seen();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->what, "windows");
    EXPECT_EQ(seen->done, 40u);
    EXPECT_EQ(seen->all, 100u);
    EXPECT_GE(seen->seconds, 0.0);
  }
  EXPECT_FALSE(WorkCounter::seen());
}

TEST(WorkCounter, AnotherIsSeenWhenTheFirstIsGone) {
  { const WorkCounter first("files", 1); }
  const WorkCounter second("candidates", 2);
  EXPECT_EQ(WorkCounter::seen()->what, "candidates");
}

}  // namespace
}  // namespace modebank
