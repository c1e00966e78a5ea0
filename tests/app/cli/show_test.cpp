#include <gmock/gmock.h>

#include <limits>

#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "app/text/text_table.hpp"

namespace modebank::test {
namespace {

TEST(NumberText, IsFixedWhereThatFits) {
  EXPECT_EQ(app::fixed_or_short(0.0348, 5), "0.03480");
  EXPECT_EQ(app::fixed_or_short(-99999.25, 1), "-99999.2");
  EXPECT_EQ(app::fixed_or_short(1e5, 3), "1e+05");
  EXPECT_EQ(app::fixed_or_short(-1.23456e15, 5), "-1.235e+15");
  EXPECT_EQ(app::fixed_or_short(std::numeric_limits<double>::quiet_NaN(), 2), "nan");
  EXPECT_EQ(app::size_list(std::vector<double>{0.5, 2e15}, 2), "0.50 2e+15");
}

TEST(Wrapped, ContinuesUnderTheLabel) {
  EXPECT_EQ(app::wrapped("windows   2250 of 25 transitions: all\nshort\n", 26),
            "windows   2250 of 25\n          transitions: all\nshort\n");
  EXPECT_EQ(app::wrapped("baseline    underconfident tails\n", 28), "baseline    underconfident\n            tails\n");
  EXPECT_EQ(app::wrapped("one/word/that/cannot/be/broken and more", 12), "one/word/that/cannot/be/broken\nand more");
  EXPECT_EQ(app::wrapped("no limit at all", 0), "no limit at all");
  EXPECT_EQ(app::columns_of("ü│▁x"), 4);
}

TEST(TextTable, ShortensWhatLeavesNoRoom) {
  const std::string tail = "odometry.twist.twist.angular.z", name = "/husky_velocity_controller/" + tail;
  app::TextTable table({{"channel", 4, app::TextTable::Align::left}, {name + " per " + name, 8}, {"AIC", 8}});
  table.add({name + " <- " + name, "1", "2"});
  for (const int width : {40, 60, 100}) {
    const std::string text = table.text(width);
    for (const std::string& line : app::lines_of(text)) EXPECT_LE(app::columns_of(line), width) << line;
    EXPECT_THAT(text, ::testing::HasSubstr("angular.z ")) << "the end is what tells names apart";
  }
  EXPECT_THAT(table.text(0), ::testing::HasSubstr(name + " <- " + name));
}

TEST(TextTable, GoesOnBelowWithItsKeyRepeated) {
  app::TextTable table({{"K", 4}, {"BIC", 8}, {"AIC", 8}, {"ICL", 8}});
  table.add({"1", "10.5", "20.5", "30.5"});
  table.add({"2", "1.5", "2.5", "3.5"}, " <-");
  EXPECT_EQ(table.text(0),
            "   K      BIC      AIC      ICL\n   1     10.5     20.5     30.5\n   2      1.5      2.5      3.5 <-\n");
  EXPECT_EQ(table.text(15), "K  BIC  AIC\n1 10.5 20.5\n2  1.5  2.5 <-\nK  ICL\n1 30.5\n2  3.5 <-\n");
  for (const std::string& line : app::lines_of(table.text(15))) EXPECT_LE(app::columns_of(line), 15) << line;
}

}  // namespace
}  // namespace modebank::test
