#include "app/study/space/study_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/config/config_file.hpp"
#include "app/config/option_text.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using Texts = std::vector<std::string>;

Config with(const std::vector<std::string>& vary) {
  Config config;
  config.study.vary = vary;
  return config;
}

std::vector<double> column(const StudySpace& space, std::size_t key) {
  std::vector<double> values;
  for (const StudyPoint& point : space.points) parse_value(point[key], values.emplace_back());
  return values;
}

/// The interval [0, 1) has N equal strata, where N is the number of values. For each stratum, how many values are in
/// it.
std::multiset<int> strata(const std::vector<double>& values) {
  std::vector<int> counts(values.size(), 0);
  for (const double value : values) ++counts.at(static_cast<std::size_t>(value * static_cast<double>(values.size())));
  return {counts.begin(), counts.end()};
}

TEST(VaryText, ExpandsValuesAndBraces) {
  EXPECT_EQ(parse_vary("mixture.components = {3..5} | 8").values, (Texts{"3", "4", "5", "8"}));
  EXPECT_EQ(parse_vary("mixture.components = {2..9 step 3}").values, (Texts{"2", "5", "8"}));
  EXPECT_EQ(parse_vary("bank.stay = {0.1..0.9 lin 5}").values, (Texts{"0.1", "0.3", "0.5", "0.7", "0.9"}));
  EXPECT_EQ(parse_vary("window.prior = {0.001..1 log 4}").values, (Texts{"0.001", "0.01", "0.1", "1"}));
  EXPECT_EQ(parse_vary("data.lag_s = {0..1 step 0.1}").values.size(), 11u);
  EXPECT_EQ(parse_vary("filter.variant = imm|kf").values, (Texts{"imm", "kf"}));
  EXPECT_EQ(parse_vary("mixture.components = 1..{5..7}").values, (Texts{"1..5", "1..6", "1..7"}));
  EXPECT_EQ(parse_vary("bank.measurement_variance =  | 0.010").values, (Texts{"", "0.01"}));  // values in the form of a
                                                                                              // resolved configuration
}

TEST(VaryText, RangesAreForSampling) {
  const VariedKey uniform = parse_vary("bank.stay = {0.5..0.99}");
  EXPECT_TRUE(uniform.is_range());
  EXPECT_FALSE(uniform.logarithmic);
  const VariedKey logarithmic = parse_vary("window.prior = {0.001..1 log}");
  EXPECT_TRUE(logarithmic.is_range() && logarithmic.logarithmic);
  EXPECT_THROW(lay_out(with({"bank.stay = {0.5..0.99}"})), ConfigurationError);
}

TEST(VaryText, ErrorsSayWhatIsWrong) {
  const auto reason = [](const std::string& line) {
    try {
      parse_vary(line);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::map<std::string, std::string> cases{
      {"mixture.component = 3", "did you mean mixture.components"},
      {"mixture.components", "has no ="},
      {"mixture.components = 0", "mixture.components the value '0'"},
      {"mixture.components = {5..3}", "the first number must be the smaller"},
      {"bank.stay = {0..1 log 3}", "above 0"},
      {"bank.stay = {0..1 lin 1}", "2 to"},
      {"bank.stay = {0..1 cubic 3}", "expected a range"},
      {"bank.stay = {0.5", "one pair of braces"},
      {"bank.stay = {0.1..0.5} | 0.9", "add a number of values"},
      {"mixture.restarts = {1.5..3}", "whole number"},
      {"job.threads = 1 | 2", "changes no number"},
      {"study.repeats = 1 | 2", "changes no number"}};
  for (const auto& [line, part] : cases) EXPECT_NE(reason(line).find(part), std::string::npos) << reason(line);
}

TEST(StudySpace, GridVariesTheLastKeyFastest) {
  const StudySpace space = lay_out(with({"mixture.components = 2 | 3", "filter.variant = imm | kf | salvi2025"}));
  EXPECT_EQ(space.keys, (Texts{"mixture.components", "filter.variant"}));
  ASSERT_EQ(space.points.size(), 6u);
  EXPECT_EQ(space.points[1], (StudyPoint{"2", "kf"}));
  EXPECT_EQ(space.points[3], (StudyPoint{"3", "imm"}));
}

TEST(StudySpace, KeysTogetherGoInStep) {
  Config config = with({"mixture.components = 2 | 3", "bank.stay = 0.9 | 0.95", "filter.variant = imm | kf"});
  config.study.together = {"mixture.components, filter.variant"};
  const StudySpace space = lay_out(config);
  ASSERT_EQ(space.points.size(), 4u);
  for (const StudyPoint& point : space.points) EXPECT_EQ(point[0] == "2", point[2] == "imm");
  config.study.vary[2] = "filter.variant = imm | kf | salvi2025";
  EXPECT_THROW(lay_out(config), ConfigurationError);
  config.study.together = {"mixture.components, window.length"};
  EXPECT_THROW(lay_out(config), ConfigurationError);
}

TEST(StudySpace, LatinHypercubeFillsEveryStratumOfEveryAxisOnce) {
  Config config = with({"data.lag_s = {0..1 lin}", "filter.variant = imm | kf", "window.prior = {0.001..1 log}"});
  config.study.sample = 20;
  const StudySpace space = lay_out(config);
  ASSERT_EQ(space.points.size(), 20u);
  for (const int count : strata(column(space, 0))) EXPECT_EQ(count, 1);
  const auto imm =
      std::count_if(space.points.begin(), space.points.end(), [](const StudyPoint& p) { return p[1] == "imm"; });
  EXPECT_EQ(imm, 10);
  std::vector<double> exponents;
  for (const double value : column(space, 2)) exponents.push_back((std::log10(value) + 3.0) / 3.0);
  for (const int count : strata(exponents)) EXPECT_EQ(count, 1);
}

TEST(StudySpace, SamplesFollowTheSeedAlone) {
  Config config = with({"data.lag_s = {0..1 lin}", "window.prior = {0.001..1 log}"});
  config.study.sample = 10;
  const std::vector<StudyPoint> first = lay_out(config).points;
  EXPECT_EQ(lay_out(config).points, first);
  config.job.seed = 2;
  EXPECT_NE(lay_out(config).points, first);
}

}  // namespace
}  // namespace modebank::app
