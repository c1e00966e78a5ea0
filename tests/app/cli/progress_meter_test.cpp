#include "app/cli/progress_meter.hpp"

#include <gtest/gtest.h>

namespace modebank::app {
namespace {

TEST(ProgressText, SaysRateAndWhatIsLeft) {
  EXPECT_EQ(progress_text({"windows", 500, 2000, 10.0}), "windows: 500 of 2000, 50 per s, 30 s left");
  EXPECT_EQ(progress_text({"fits of modes", 1, 3, 300.0}), "fits of modes: 1 of 3, 12 per h, 10 min left");
  EXPECT_EQ(progress_text({"files", 0, 3, 5.0}), "files: 0 of 3");
  EXPECT_EQ(progress_text({"files", 3, 3, 1.5}), "files: 3 of 3, 2 per s");
}

}  // namespace
}  // namespace modebank::app
