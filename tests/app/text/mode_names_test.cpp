// Names of modes come from the user, or from a label that enough samples of the mode have. A mode may have no name.
#include "app/text/mode_names.hpp"

#include <gmock/gmock.h>

#include "app/text/confusion_text.hpp"
#include "app/text/mode_tables.hpp"
#include "app/text/summary_tables.hpp"
#include "tests/app/text/screen_archive.hpp"

namespace modebank::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Warnings : public Listener {
 public:
  void warning(const std::string& text) const override { said += text + "\n"; }
  mutable std::string said;
};

/// Three modes with the labels: 60 of 100 samples on ice, 59 of 100 on ice, 40 of 40 on grip.
Archive labelled() {
  Archive archive = screen_archive(1, 1, 3);
  archive.confusion = {{"bank", Role::test, "grip", 0, 40, 40.0 / 121}, {"bank", Role::test, "grip", 1, 41, 41.0 / 121},
                       {"bank", Role::test, "grip", 2, 40, 40.0 / 121}, {"bank", Role::test, "ice", 0, 60, 60.0 / 119},
                       {"bank", Role::test, "ice", 1, 59, 59.0 / 119},  {"bank", Role::test, "ice", 2, 0, 0.0}};
  return archive;
}

TEST(ModeNames, AreTheLabelsOfSixtyPercentOfTheSamples) {
  const Warnings warnings;
  Archive archive = labelled();
  EXPECT_THAT(mode_names_of(archive, {}, warnings), ElementsAre("ice", "", "grip"));
  EXPECT_THAT(mode_names_of(archive, {"wet", "", "dry"}, warnings), ElementsAre("wet", "", "dry"));
  EXPECT_THAT(warnings.said, IsEmpty());
  for (ConfusionRow& row : archive.confusion) row.label = row.label == "ice" ? "-1" : "2";
  EXPECT_THAT(mode_names_of(archive, {}, warnings), ElementsAre("label -1", "", "label 2")) << "no numbers of modes";
  archive.confusion.clear();
  EXPECT_THAT(mode_names_of(archive, {}, warnings), IsEmpty());
  archive.bank.reset();
  EXPECT_THAT(mode_names_of(archive, {"a"}, warnings), IsEmpty());
}

TEST(ModeNames, AWrongCountIsSaidAndCostsNoRun) {
  const Warnings fewer, more;
  EXPECT_THAT(mode_names_of(labelled(), {"wet"}, fewer), ElementsAre("wet", "", "grip"));
  EXPECT_EQ(fewer.said, "bank.mode_names has 1 name, but the bank has 3 modes: it names only the first modes\n");
  EXPECT_THAT(mode_names_of(labelled(), {"a", "b", "c", "d"}, more), ElementsAre("a", "b", "c"));
  EXPECT_EQ(more.said, "bank.mode_names has 4 names, but the bank has 3 modes: its last names are not used\n");
}

TEST(ModeNames, StandBesideNumbersOnOneLine) {
  const std::vector<std::string> names{"ice", "", "a\n\x1b[31mb"};
  EXPECT_EQ(mode_cell(names, 0), "0 ice");
  EXPECT_EQ(mode_title(names, 0), "mode 0: ice");
  EXPECT_EQ(mode_cell(names, 1), "1");
  EXPECT_EQ(mode_title(names, 7), "mode 7");
  EXPECT_EQ(mode_cell(names, 2), "2 a  [31mb");
}

TEST(ModeNames, StandWhereverModesAreListed) {
  Archive archive = labelled();
  archive.mode_names = {"ice", "", "grip"};
  for (const std::string& text : {app::modes_in_words(archive), app::short_modes(archive, 9, 200).text,
                                  app::modes_text(archive, false), app::mode_diagnostics_text(archive)}) {
    EXPECT_THAT(text, HasSubstr("0 ice "));
    EXPECT_THAT(text, HasSubstr("2 grip"));
  }
  const std::string confusion = app::confusion_text(archive, 0);
  EXPECT_THAT(confusion, HasSubstr("mode 0: ice"));
  EXPECT_THAT(confusion, HasSubstr("50.4 %"));  // 60 of 119 samples
}

}  // namespace
}  // namespace modebank::test
