// The label of a parameter must match the column of its regressor.
#include "ident/model/parameter_labels.hpp"

#include <gtest/gtest.h>

namespace modebank {
namespace {

using Names = std::vector<std::string>;

TEST(ParameterLabels, OneStateInTheDatasNames) {
  EXPECT_EQ(parameter_labels({1, 2, true}, {"wz"}, {"velL", "velR"}),
            (Names{"wz <- wz", "wz <- velL", "wz <- velR", "wz <- 1"}));
}

TEST(ParameterLabels, SeveralStatesRowByRow) {
  EXPECT_EQ(parameter_labels({2, 1, false}, {"wz", "vx"}, {"u"}),
            (Names{"wz <- wz", "wz <- vx", "wz <- u", "vx <- wz", "vx <- vx", "vx <- u"}));
}

/// theta is [A_1 A_2 B_0 B_1]; a bank has a name for each lagged sample.
TEST(ParameterLabels, LagsAsABankNamesThem) {
  EXPECT_EQ(parameter_labels({1, 2, false, 2, 2, 0}, {"wz", "wz[k-1]"}, {"l[k+1]", "r[k+1]", "l", "r"}),
            (Names{"wz <- wz (lag 1)", "wz <- wz (lag 2)", "wz <- l (lag 0)", "wz <- r (lag 0)", "wz <- l (lag 1)",
                   "wz <- r (lag 1)"}));
}

TEST(ParameterLabels, LagsCountFromTheInputsOwnDelay) {
  EXPECT_EQ(parameter_labels({1, 2, false, 1, 2, InputDelays({1, 4})}, {"wz"}, {"l", "r"}),
            (Names{"wz <- wz (lag 1)", "wz <- l (lag 1)", "wz <- r (lag 4)", "wz <- l (lag 2)", "wz <- r (lag 5)"}));
}

/// The position of the label must match the entry for that name in A, B or c.
TEST(ParameterLabels, StandInThetasOrder) {
  const LinearStructure structure{2, 2, true, 3, 2, 2};
  const Names labels = parameter_labels(structure, {"p", "q"}, {"l", "r"}), codes = structure.parameter_names();
  ASSERT_EQ(labels.size(), codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const bool constant = codes[i][0] == 'c';
    const std::string row = codes[i][1] == '1' ? "p" : "q";
    const std::string from = codes[i][0] == 'A' ? (codes[i][2] == '1' ? "p" : "q") : (codes[i][2] == '1' ? "l" : "r");
    const std::string lag = constant ? "" : codes[i].substr(codes[i].find("_lag") + 4);
    EXPECT_EQ(labels[i], constant ? row + " <- 1" : row + " <- " + from + " (lag " + lag + ")") << codes[i];
  }
}

TEST(ParameterLabels, UnitsInBracketsBelongToTheName) {
  EXPECT_EQ(parameter_labels({1, 1, false}, {"v[km/h]"}, {"a[k-b] c"}),
            (Names{"v[km/h] <- v[km/h]", "v[km/h] <- a[k-b] c"}));
}

TEST(ParameterLabels, UnnamedChannelsAreNumbered) {
  EXPECT_EQ(parameter_labels({1, 1, false}, {}, {}), (Names{"x1 <- x1", "x1 <- u1"}));
}

TEST(ParameterLabels, MotionModelsHaveNamesOfTheirOwn) {
  WindowFits fits;
  fits.structure = {1, 2, false};
  EXPECT_EQ(parameter_labels(fits, {"wz"}, {"l", "r"}).front(), "wz <- wz");
  fits.model_parameters = {{"track", "m"}};
  EXPECT_EQ(parameter_labels(fits, {"wz"}, {"l", "r"}), Names{"track"});
}

}  // namespace
}  // namespace modebank
