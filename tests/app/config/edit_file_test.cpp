// Tests that set keys in the text of a configuration file.
#include "app/config/edit_file.hpp"

#include <gtest/gtest.h>

namespace modebank::app {
namespace {

TEST(EditedText, SetsKeysAndLeavesTheRestAsItIs) {
  const std::string text =
      "# mine\n[data]\nstate = wz   # yaw\n\n[window]\nlength = 25  # four seconds\n\n[study]\nvary = a\nvary = b\n";
  EXPECT_EQ(edited_text(text, {}), text);
  const std::string edited = edited_text(text, {{"window.length", {"40"}, "why"},
                                                {"data.rate_hz", {"10"}, ""},
                                                {"study.vary", {"c", "d"}, ""},
                                                {"job.seed", {"2"}, "x"}});
  EXPECT_EQ(edited,
            "# mine\n[data]\nstate = wz   # yaw\nrate_hz = 10\n\n[window]\n# was: length = 25  # four seconds\n# why\n"
            "length = 40\n\n[study]\n# was: vary = a\nvary = c\nvary = d\n# was: vary = b\n\n[job]\n# x\nseed = 2\n");
}

TEST(EditedText, KnowsKeysFromCommentsAndOtherSections) {
  EXPECT_EQ(edited_text("[mixture]\nlength = 1\n[window]\n# length = 2\n", {{"window.length", {"3"}, ""}}),
            "[mixture]\nlength = 1\n[window]\n# length = 2\nlength = 3\n");
  EXPECT_EQ(edited_text("window.length=1", {{"window.length", {""}, ""}}), "# was: window.length=1\nwindow.length =\n");
}

}  // namespace
}  // namespace modebank::app
