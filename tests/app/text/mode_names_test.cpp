// Names of modes come from the user, or from a label that enough samples of the mode have. A mode may have no name.
#include "app/text/mode_names.hpp"

#include <gmock/gmock.h>

#include "tests/app/text/screen_archive.hpp"

namespace modebank::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Three modes with the labels: 60 of 100 samples on ice, 59 of 100 on ice, 40 of 40 on grip.
Archive labelled() {
  Archive archive = screen_archive(1, 1, 3);
  archive.confusion = {{"bank", Role::test, "grip", 0, 40, 40.0 / 121}, {"bank", Role::test, "grip", 1, 41, 41.0 / 121},
                       {"bank", Role::test, "grip", 2, 40, 40.0 / 121}, {"bank", Role::test, "ice", 0, 60, 60.0 / 119},
                       {"bank", Role::test, "ice", 1, 59, 59.0 / 119},  {"bank", Role::test, "ice", 2, 0, 0.0}};
  return archive;
}

TEST(ModeNames, AreTheLabelsOfSixtyPercentOfTheSamples) {
  std::string said;
  const Tell warnings = [&](Level, const std::string& text) { said += text + "\n"; };
  Archive archive = labelled();
  EXPECT_THAT(mode_names_of(archive, {}, warnings), ElementsAre("ice", "", "grip"));
  EXPECT_THAT(mode_names_of(archive, {"wet", "", "dry"}, warnings), ElementsAre("wet", "", "dry"));
  EXPECT_THAT(said, IsEmpty());
  for (ConfusionRow& row : archive.confusion) row.label = row.label == "ice" ? "-1" : "2";
  EXPECT_THAT(mode_names_of(archive, {}, warnings), ElementsAre("label -1", "", "label 2")) << "no numbers of modes";
  archive.confusion.clear();
  EXPECT_THAT(mode_names_of(archive, {}, warnings), IsEmpty());
  archive.bank.reset();
  EXPECT_THAT(mode_names_of(archive, {"a"}, warnings), IsEmpty());
}

TEST(ModeNames, StandBesideNumbersOnOneLine) {
  const std::vector<std::string> names{"ice", "", "a\n\x1b[31mb"};
  EXPECT_EQ(mode_cell(names, 0), "0 ice");
  EXPECT_EQ(mode_title(names, 0), "mode 0: ice");
  EXPECT_EQ(mode_cell(names, 1), "1");
  EXPECT_EQ(mode_title(names, 7), "mode 7");
  EXPECT_EQ(mode_cell(names, 2), "2 a  [31mb");
}

}  // namespace
}  // namespace modebank::test
