// The filters, compared with tests/golden/generate/imm_reference.py, an independent textbook implementation in numpy.
#include "tests/support/golden.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "filter/judge/run/evaluate.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using nlohmann::json;
using test::golden_columns;
using test::golden_rows;
using test::near;

/// Both implementations use double precision over 40 steps, with condition numbers below 1e3.
constexpr double tolerance = 1e-10;
/// The first covariances of the unobserved state are about ten. Their relative accuracy is the same.
constexpr double relative_tolerance = 1e-10;

Bank read_bank(const json& golden) {
  const json& source = golden.at("bank");
  Bank bank;
  bank.C = golden_rows(source.at("C"));
  bank.R = golden_rows(source.at("R"));
  bank.transition = TransitionMatrix(golden_rows(source.at("T")));
  bank.initial_probability = golden_rows(source.at("pi"));
  for (std::size_t j = 0; j < source.at("modes").size(); ++j) {
    const json& mode = source.at("modes")[j];
    bank.modes.push_back({});
    bank.modes[j].model = {golden_rows(mode.at("A")), golden_rows(mode.at("B")), golden_rows(mode.at("c"))};
    bank.modes[j].Q = golden_rows(mode.at("Q"));
  }
  bank.structure = {bank.modes[0].model.A.rows(), bank.modes[0].model.B.cols(), true};
  return bank;
}

class GoldenFilter : public testing::TestWithParam<const char*> {};

TEST_P(GoldenFilter, AgreesWithTheIndependentReference) {
  const json golden = test::read_golden(GetParam());
  Trajectory run;
  run.input = golden_columns(golden.at("input"));
  run.state = golden_columns(golden.at("measurement"));
  FilterOptions options;
  options.variant = parse_name<FilterVariant>(golden.at("variant").get<std::string>()).value();

  const RunEvaluation actual = evaluate_run(read_bank(golden), run, options);

  const json& expected = golden.at("expected");
  const auto agrees = [&](const char* name, const Eigen::MatrixXd& value) {
    const Eigen::MatrixXd reference = golden_columns(expected.at(name));
    double scale = 1.0;
    for (const double entry : reference.reshaped())
      scale = std::isnan(entry) ? scale : std::max(scale, std::abs(entry));
    EXPECT_TRUE(near(value, reference, std::max(tolerance, relative_tolerance * scale))) << name;
  };
  agrees("prediction", actual.prediction);
  agrees("innovation", actual.innovation);
  agrees("innovation_covariance", actual.innovation_covariance);
  agrees("state", actual.state);
  agrees("covariance", actual.covariance);
  agrees("nis", actual.nis.transpose());
  agrees("pit", actual.pit);
  agrees("log_density", actual.log_density.transpose());
  agrees("predicted", actual.mode_probability_predicted);
  agrees("mu", actual.mode_probability);
}

INSTANTIATE_TEST_SUITE_P(Cases, GoldenFilter,
                         testing::Values("imm_scalar", "imm_vector", "imm_partial", "imm_missing", "imm_three",
                                         "salvi2025_scalar", "salvi2025_vector"),
                         [](const auto& parameter) { return std::string(parameter.param); });

}  // namespace
}  // namespace modebank
