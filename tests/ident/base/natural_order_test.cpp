#include "ident/base/natural_order.hpp"

#include <gtest/gtest.h>

namespace modebank {
namespace {

TEST(NaturalOrder, NumbersInNamesCount) {
  EXPECT_TRUE(natural_less("run_2", "run_10"));
  EXPECT_FALSE(natural_less("run_10", "run_2"));
  EXPECT_TRUE(natural_less("run_02", "run_10"));
  EXPECT_TRUE(natural_less("drive.b9", "drive.b10"));
  EXPECT_TRUE(natural_less("run", "run_1"));
  EXPECT_FALSE(natural_less("a", "a"));
  EXPECT_EQ(natural_order({"b10", "b2", "a", "b1"}), (std::vector<std::size_t>{2, 3, 1, 0}));
}

}  // namespace
}  // namespace modebank
