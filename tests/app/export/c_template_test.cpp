// filter.h and filter.c are compiled unchanged with the table of small_bank. The files that `export` makes are
// compiled, too.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "app/export/c/c_table.hpp"
#include "app/export/c/filter.h"
#include "app/export/c/templates.hpp"
#include "app/export/forms.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/gaussian.hpp"
#include "filter/step/samples.hpp"
#include "tests/app/export/exported.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::app::test {
namespace {

using ::testing::HasSubstr;

/// Every number has few binary digits, so that its text is short. The bank has all features that the C code supports.
ExportedBank small_bank() {
  Bank bank = modebank::test::example_bank(1, 1, 2, 0.0);
  bank.structure = {1, 1, true, 2, 1, 1};
  bank.modes[0].model = unpack(bank.structure, Eigen::Vector4d(-0.25, -0.125, 0.5, 0.0625));
  bank.modes[1].model = unpack(bank.structure, Eigen::Vector4d(-0.0625, 0.03125, 0.125, 0.0));
  const double Q[] = {0.0009765625, 0.0078125};
  for (std::size_t k = 0; k < 2; ++k) {
    bank.modes[k].Q = Eigen::Matrix2d{{Q[k], 0.0}, {0.0, 0.0}};
    bank.modes[k].parameter_covariance.resize(0, 0);
  }
  bank.C = Eigen::MatrixXd::Identity(1, 2);
  bank.R = Eigen::MatrixXd::Constant(1, 1, 0.0001220703125);
  bank.dt_s = 0.125;
  bank.transition = TransitionMatrix(Eigen::Matrix2d{{0.875, 0.125}, {0.25, 0.75}});
  bank.transition_logit.weights = Eigen::MatrixXd{{0.0, 0.0, 0.0}, {2.0, -1.0, 4.0}};
  bank.transition_logit.reference = Eigen::Vector3d(0.125, 0.0, 0.25);
  ExportedBank exported = as_exported(bank);
  exported.mode_names[0] = "wet ice";
  for (ModeErrors& errors : exported.errors) errors.A.setConstant(0.125);
  return exported;
}

std::string content(const std::string& name) {
  std::ifstream stream(modebank::test::project_dir() / "tests/app/export/small_bank" / name);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void expect_near(const double* found, const Eigen::MatrixXd& expected) {
  for (Index i = 0; i < expected.size(); ++i) {
    const double value = expected.transpose().reshaped()(i);
    if (std::isnan(value))
      EXPECT_TRUE(std::isnan(found[i]));
    else
      EXPECT_NEAR(found[i], value, 1e-12 * std::max(1.0, std::abs(value)));
  }
}

TEST(CTemplate, TheTableBesideItIsWhatExportWrites) {
  EXPECT_EQ(c_form::bank_sizes(small_bank(), "MODEBANK"), content("bank_sizes.h"));
  EXPECT_EQ(c_form::bank_numbers(small_bank()), content("bank_numbers.h"));
}

TEST(CTemplate, StepsAsBankFilterDoes) {
  const ExportedBank exported = small_bank();
  const Bank source = modebank::test::example_bank(1, 1, 2, 1e-3);
  const Trajectory run = disturbed(modebank::test::simulate_bank(source, 400, 3), exported.bank.dt_s);
  BankFilter filter(exported.bank, exported.options);
  modebank_filter c_filter, ahead;
  modebank_restart(&c_filter);
  for (Index k = 0; k < run.samples(); ++k) {
    SCOPED_TRACE(k);
    const FilterEstimate expected = filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    modebank_estimate estimate;
    modebank_step(&c_filter, run.time_s(k), run.input.col(k).data(), run.state.col(k).data(), &estimate);
    EXPECT_EQ(estimate.steps, expected.steps);
    expect_near(estimate.prediction, expected.prediction);
    expect_near(estimate.state, expected.state);
    expect_near(&estimate.covariance[0][0], expected.covariance);
    expect_near(&estimate.innovation_covariance[0][0], expected.innovation_covariance);
    expect_near(estimate.mode_probability, expected.mode_probability);
    expect_near(&estimate.log_density, Eigen::MatrixXd::Constant(1, 1, expected.log_density));
    double mean = 0.0, covariance = 0.0;
    modebank_predict(&c_filter, &ahead, 1, run.input.col(k).data(), &mean, &covariance);
    const std::vector<double> snapshot = filter.snapshot();
    const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(1, std::nan(""));
    const FilterEstimate& next = filter.step(std::nan(""), run.input.col(k), nothing);
    expect_near(&mean, exported.bank.C * next.prediction);
    expect_near(&covariance, next.innovation_covariance);
    filter.restore(snapshot);
  }
}

/// The bounds in C++ equal the bounds in C.
TEST(CTemplate, HasTheBoundsOfTheEquations) {
  const std::string text(assets::filter_c());
  const auto value = [&](const std::string& name) {
    std::smatch found;
    const std::regex line(name + "(?: =)? \\(?(-?[0-9.e+-]+)");
    return std::regex_search(text, found, line) ? std::stod(found[1]) : std::nan("");
  };
  EXPECT_EQ(value("LARGEST_VARIANCE"), largest_variance);
  EXPECT_EQ(value("LARGEST_MEAN"), largest_mean);
  EXPECT_EQ(value("LEAST_VARIANCE"), least_variance);
  EXPECT_EQ(value("IMPOSSIBLE"), impossible_probability);
  EXPECT_EQ(value("LEAST_PROBABILITY"), mode_probability_floor);
  EXPECT_EQ(value("LOWEST_LOG_DENSITY"), lowest_log_density);
  EXPECT_EQ(value("LARGEST_MEASUREMENT"), largest_measurement);
  EXPECT_EQ(value("LEAST_PIVOT"), relative_pivot_floor);
  EXPECT_EQ(value("LEAST_LOG_ODDS"), -largest_log_odds);
  EXPECT_EQ(value("LONGEST_GAP"), static_cast<double>(longest_gap_steps));
}

TEST(CTemplate, ModesHaveEnumerators) {
  ExportedBank exported = as_exported(modebank::test::example_bank(1, 1, 4));
  exported.mode_names = {"Glätte", "mode 1", "grip", "grip"};
  const std::string header = to_c(exported, "robot").header;
  EXPECT_THAT(header, HasSubstr("  ROBOT_MODE_Gl_tte = 0, /* Glätte */\n  ROBOT_MODE_1 = 1, /* mode 1 */\n"
                                "  ROBOT_MODE_grip = 2, /* grip */\n  ROBOT_MODE_grip_2 = 3 /* grip */\n"));
}

/// Signals or files have the same names as identifiers of the program.
TEST(CTemplate, CompilesUnderAnyName) {
  ExportedBank exported = as_exported(modebank::test::example_bank(1, 3, 3));
  exported.mode_names = {"S", "mode 0", "2"};
  exported.recorded_inputs = {{"SAMPLES", ""}, {"ROOM", ""}, {"DELAY", ""}};
  exported.states[0] = exported.measurements[0] = {"LAGS", ""};
  const modebank::test::TemporaryFolder folder;
  for (const std::string stem : {"acting", "bank", "clear", "double", "kept", "largest", "mode", "modebank", "record",
                                 "state", "step", "transition-by", "x"}) {
    const CFiles files = to_c(exported, stem);
    modebank::test::write_file(folder.path() / (stem + ".h"), files.header);
    modebank::test::write_file(folder.path() / (stem + ".c"), files.source);
    const auto compiled =
        modebank::test::run_program({"/usr/bin/cc", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion",
                                     "-Werror", "-fsyntax-only", (folder.path() / (stem + ".c")).string()});
    EXPECT_EQ(compiled.status, 0) << stem << "\n" << compiled.err;
  }
}

}  // namespace
}  // namespace modebank::app::test
