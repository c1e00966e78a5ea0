#include "io/import/expression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"

namespace modebank {
namespace {

using std::numbers::pi;
using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::NanSensitiveDoubleEq;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
using Columns = std::map<std::string, std::vector<double>>;

/// Values of a formula at 0, 0.5, 1, ... seconds, one for each row of the columns. Without columns there is one row.
std::vector<double> values(const std::string& text, const Columns& columns = {}) {
  const Expression expression("data.derive", text);
  std::vector<std::span<const double>> operands;
  std::size_t rows = 1;
  for (const std::string& name : expression.channels()) {
    operands.emplace_back(columns.at(name));
    rows = operands.back().size();
  }
  std::vector<double> time_s(rows);
  for (std::size_t k = 0; k < rows; ++k) time_s[k] = 0.5 * static_cast<double>(k);
  return expression.evaluate(operands, time_s);
}

double value(const std::string& text, const Columns& columns = {}) { return values(text, columns).at(0); }

std::string error(const std::string& text) {
  return message_of<ConfigurationError>([&] { Expression("data.derive = " + text.substr(0, 50), text); });
}

TEST(Expression, ComputesAsArithmeticDoes) {
  EXPECT_DOUBLE_EQ(value("1 + 2 * 3 - 4 / 8"), 6.5);
  EXPECT_DOUBLE_EQ(value("-2 ^ 2"), -4.0);
  EXPECT_DOUBLE_EQ(value("2 ^ 3 ^ 2"), 512.0);
  EXPECT_DOUBLE_EQ(value("(1 + 2) * -3"), -9.0);
  EXPECT_DOUBLE_EQ(value("1e-3 * .5"), 5e-4);
  EXPECT_DOUBLE_EQ(value("3 > 2 && 1 <= 0 || 5 != 5"), 0.0);
  EXPECT_DOUBLE_EQ(value("2 == 2 ? 7 : 8"), 7.0);
  EXPECT_DOUBLE_EQ(value("v * tan(steer)", {{"v", {2.0}}, {"steer", {0.3}}}), 2.0 * std::tan(0.3));
}

TEST(Expression, KnowsItsFunctions) {
  EXPECT_DOUBLE_EQ(value("log(exp(2)) + log10(1000) + log2(8)"), 8.0);
  EXPECT_DOUBLE_EQ(value("atan2(1, -1)"), 0.75 * pi);
  EXPECT_DOUBLE_EQ(value("hypot(3, 4) + abs(-1) + sign(-7) + sqrt(9)"), 8.0);
  EXPECT_DOUBLE_EQ(value("min(3, 1, 2) + max(4, 6)"), 7.0);
  for (const char* formula : {"min(sqrt(-1), 1)", "min(1, sqrt(-1))", "max(sqrt(-1), 1)", "max(1, 2, sqrt(-1), 3)",
                              "sign(sqrt(-1))", "not(sqrt(-1))"})
    EXPECT_TRUE(std::isnan(value(formula))) << formula;
  EXPECT_DOUBLE_EQ(value("mod(-1, 3) + floor(1.5) + ceil(1.5) + round(1.6) + not(0)"), 8.0);
  EXPECT_DOUBLE_EQ(value("rad(180) + deg(pi)"), pi + 180.0);
  EXPECT_NEAR(value("wrap(7)"), 7.0 - 2.0 * pi, 1e-15);
}

TEST(Expression, NamesChannelsThatAreNoIdentifiersInQuotes) {
  const Columns columns{{"/odom.twist.twist.linear.x", {2.0}},
                        {"/joint_states.velocity{left}", {3.0}},
                        {"it's", {5.0}},
                        {"imu.wz", {7.0}},
                        {"min", {11.0}},
                        {"pi", {13.0}}};
  EXPECT_EQ(value("'/odom.twist.twist.linear.x' + '/joint_states.velocity{left}'", columns), 5.0);
  EXPECT_EQ(value("'it''s' * imu.wz + min", columns), 46.0);
  EXPECT_EQ(value("'pi'", columns), 13.0);
  EXPECT_THAT(Expression("", "b + a*b - 'c d' + pi").channels(), ElementsAre("b", "a", "c d"));
}

TEST(Expression, TakesYawFromAQuaternion) {
  for (const double yaw : {-3.0, -0.4, 0.0, 1.2, 3.1}) {
    const double pitch = 0.3, roll = -0.7;  // the rotation Rz(yaw) Ry(pitch) Rx(roll), computed by the half-angle
                                            // formula
    const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2), cp = std::cos(pitch / 2), sp = std::sin(pitch / 2),
                 cr = std::cos(roll / 2), sr = std::sin(roll / 2);
    EXPECT_NEAR(value("yaw(x, y, z, w)", {{"x", {sr * cp * cy - cr * sp * sy}},
                                          {"y", {cr * sp * cy + sr * cp * sy}},
                                          {"z", {cr * cp * sy - sr * sp * cy}},
                                          {"w", {cr * cp * cy + sr * sp * sy}}}),
                yaw, 1e-12);
  }
}

TEST(Expression, RotatesVectors) {
  // The IMU lies on its side. A quarter turn about x moves gravity from +y to +z.
  EXPECT_NEAR(value("rotate_z(pi/2, 0, 0, 0.1, 9.8, 0.2)"), 9.8, 1e-12);
  EXPECT_NEAR(value("rotate_y(pi/2, 0, 0, 0.1, 9.8, 0.2)"), -0.2, 1e-12);
  EXPECT_NEAR(value("rotate_x(0, pi/2, 0, 1, 2, 3)"), 3.0, 1e-12);
  EXPECT_NEAR(value("rotate_x(0, 0, pi/2, 1, 2, 3)"), -2.0, 1e-12);
  EXPECT_NEAR(value("rotate_y(pi/2, 0, pi/2, 1, 2, 3)"), 1.0, 1e-12) << "about x first";
}

TEST(Expression, DifferentiatesPerSecond) {
  EXPECT_THAT(values("diff(x)", {{"x", {1.0, 2.0, 4.0, 3.0}}}), ElementsAre(2.0, 2.0, 4.0, -2.0));
  EXPECT_THAT(values("2 * diff(x * y) + x", {{"x", {1.0, 2.0}}, {"y", {3.0, 4.0}}}), ElementsAre(21.0, 22.0));
  EXPECT_THAT(values("diff(diff(x))", {{"x", {0.0, 1.0, 4.0}}}), ElementsAre(0.0, 0.0, 8.0));
  EXPECT_TRUE(std::isnan(value("diff(x)", {{"x", {1.0}}})));
}

TEST(Expression, Unwraps) {
  const std::vector<double> angles{3.0, -3.0, missing, -2.5, 3.1};
  const std::vector<double> unwrapped = values("unwrap(a)", {{"a", angles}});
  EXPECT_THAT(unwrapped, ElementsAre(3.0, testing::DoubleNear(2.0 * pi - 3.0, 1e-12), NanSensitiveDoubleEq(missing),
                                     testing::DoubleNear(2.0 * pi - 2.5, 1e-12), testing::DoubleNear(3.1, 1e-12)));
}

TEST(Expression, OfAMissingOperandIsMissing) {
  const Columns columns{{"x", {1.0, missing, 3.0}}, {"y", {missing, 1.0, 0.0}}};
  EXPECT_THAT(values("x > 0 ? 1 : y", columns),
              ElementsAre(NanSensitiveDoubleEq(missing), NanSensitiveDoubleEq(missing), 1.0));
  EXPECT_THAT(values("x < 2", columns), ElementsAre(1.0, NanSensitiveDoubleEq(missing), 0.0));
  EXPECT_TRUE(std::isnan(values("x / y", columns)[2])) << "what is not finite is missing";
  EXPECT_TRUE(std::isnan(value("log(-1)")));
  EXPECT_THAT(values("diff(x)", columns), testing::Each(testing::IsNan()));
}

TEST(Expression, SaysWhereItIsNone) {
  EXPECT_THAT(error(""), HasSubstr("there is no expression"));
  EXPECT_THAT(error("v *"), HasSubstr("ends too early"));
  EXPECT_THAT(error("v * * 2"), HasSubstr("at character 5 (\"* 2\")"));
  EXPECT_THAT(error("long_name + (2"), HasSubstr("a parenthesis is not closed"));
  EXPECT_THAT(error("a + 2)"), HasSubstr("at character 6 (\")\"): this closes"));
  EXPECT_THAT(error("a b"), HasSubstr("at character 3 (\"b\"): an operator is missing"));
  EXPECT_THAT(error("tan(a, b)"), HasSubstr("too many arguments"));
  EXPECT_THAT(error("atan2(a)"), HasSubstr("too few arguments"));
  EXPECT_THAT(error("sine(a)"), HasSubstr("at character 1 (\"sine(a)\"): no function sine, did you mean"));
  EXPECT_THAT(error("a = 2"), HasSubstr("a comparison is =="));
  EXPECT_THAT(error("a ? 1"), HasSubstr("needs its : B"));
  EXPECT_THAT(error("'a"), HasSubstr("no closing quote"));
  EXPECT_THAT(error("2v"), HasSubstr("at character 1 (\"2v\"): a number and a name need an operator"));
  EXPECT_THAT(error("diff()"), HasSubstr("diff needs an argument"));
  EXPECT_THAT(error("1 + diff(a, b)"), HasSubstr("at character 11 (\", b)\"): a comma"));
  EXPECT_THAT(error("1e999"), HasSubstr("fit a double"));
  EXPECT_THAT(error("\"text\""), HasSubstr("neither a number"));
  EXPECT_THAT(error("a; system(1)"), HasSubstr("neither a number"));
}

TEST(Expression, BoundsWhatIsHostile) {
  EXPECT_THAT(error(std::string(3000, '-') + "1"), HasSubstr("at most 2000"));
  EXPECT_THAT(error(std::string(60, '(') + "1" + std::string(60, ')')), HasSubstr("more than 50 deep"));
  std::string deep = "x";
  for (int i = 0; i < 60; ++i) deep = "diff(" + deep + ")";
  EXPECT_THAT(error(deep), HasSubstr("more than 50"));
  EXPECT_THAT(error(std::string(1200, '-') + "1"), HasSubstr("at character 2"));
  std::string sum = "1";
  for (int i = 1; i < 900; ++i) sum += "+1";
  EXPECT_EQ(value(sum), 900.0);
}

/// Any text must be a valid formula or cause a ConfigurationError.
TEST(Expression, SurvivesRandomText) {
  std::mt19937_64 generator(1);
  const std::vector<std::string> pieces{"a",       "'b c'", "1", ".5e3", "+",    "-",    "*",  "/",    "^",     "(",
                                        ")",       ",",     "?", ":",    "==",   "<",    "&&", "sin(", "diff(", "min(",
                                        "unwrap(", "yaw(",  "=", "'",    "\x01", "\xFF", "pi", "c0",   " "};
  for (int trial = 0; trial < 20'000; ++trial) {
    std::string text;
    for (std::size_t i = generator() % 12; i > 0; --i) text += pieces[generator() % pieces.size()];
    try {
      const Expression expression("key", text);
      const std::vector<double> column{1.0, 2.0};
      const std::vector<double> result =
          expression.evaluate(std::vector<std::span<const double>>(expression.channels().size(), column), column);
      EXPECT_EQ(result.size(), 2U) << text;
    } catch (const ConfigurationError&) {
    }
  }
}

}  // namespace
}  // namespace modebank
