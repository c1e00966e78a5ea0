// The command `modebank export`.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Export : public CliTest {
 protected:
  void SetUp() override { ASSERT_EQ(run({"--data.state_unit", "rad/s", "--data.input_unit", "m/s"}).status, 0); }

  std::string text_of(const std::filesystem::path& name) const {
    std::ifstream stream(name);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  ProgramResult exported(const std::string& form, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{"export", archive(), "--to", form};
    words.insert(words.end(), options.begin(), options.end());
    return modebank(words);
  }
  /// Sets the bank's verdict.
  void judge(Calibration verdict) const {
    Archive stored = read_archive(archive());
    for (DiagnosticsRow& row : stored.diagnostics) row.verdict = verdict;
    write_archive(archive(), stored);
  }
};

/// No export contains these numbers without a remark: a value below its standard error, an unidentifiable parameter, an
/// R at its bound.
TEST_F(Export, DoubtfulNumbersAreRemarkedInEveryForm) {
  judge(Calibration::calibrated);
  Archive stored = read_archive(archive());
  Mode& mode = stored.bank->modes[0];
  mode.standard_error = Eigen::VectorXd::Constant(mode.standard_error.size(), 1e-6);
  mode.standard_error(1) = 2.0 * std::abs(stored.bank->theta(0)(1)) + 1e-3;
  stored.windows->global.covariance.row(2).setConstant(std::nan(""));
  stored.windows->global.covariance.col(2).setConstant(std::nan(""));
  stored.bank->R(0, 0) = 1e-14;
  write_archive(archive(), stored);
  const json page = json::parse(exported("json").out);
  EXPECT_EQ(page.at("modes").at(0).at("parameters").at(1).at("remark"), "its standard error exceeds it");
  EXPECT_EQ(page.at("modes").at(0).at("parameters").at(2).at("remark"), "not identifiable");
  EXPECT_FALSE(page.at("modes").at(0).at("parameters").at(0).contains("remark"));
  ASSERT_EQ(exported("c", {"-o", file("bank.c").string()}).status, 0);
  for (const std::string& text : {page.at("remarks").dump(), text_of(file("bank.c"))})
    EXPECT_THAT(
        text, testing::AllOf(HasSubstr("standard errors exceed the values"),
                             HasSubstr("not identifiable from the training runs"), HasSubstr("is at its lower bound")));
}

TEST_F(Export, ModesHaveTheirNames) {
  judge(Calibration::calibrated);
  Archive stored = read_archive(archive());
  stored.mode_names.assign(static_cast<std::size_t>(stored.bank->mode_count()), "");
  stored.mode_names[0] = "ice\n*/";
  write_archive(archive(), stored);
  EXPECT_EQ(modebank({"verify", archive()}).status, 1) << "names have one line";
  stored.mode_names[0] = "ice */ \"grit\"";
  write_archive(archive(), stored);
  const json modes = json::parse(exported("json").out).at("modes");
  EXPECT_EQ(modes.at(0).at("name"), "ice */ \"grit\"");
  for (std::size_t k = 1; k < modes.size(); ++k) EXPECT_EQ(modes.at(k).at("name"), "mode " + std::to_string(k));
}

TEST_F(Export, WritesFilesWholeOrNotAtAll) {
  judge(Calibration::calibrated);
  ASSERT_EQ(exported("c", {"-o", file("robot.c").string()}).status, 0);
  EXPECT_THAT(text_of(file("robot.h")), HasSubstr("typedef double robot_real;"));
  EXPECT_THAT(left_behind(), ::testing::ElementsAre("out.h5", "robot.c", "robot.h"));
  EXPECT_EQ(exported("json", {"-o", file("none/robot.json").string()}).status, 2);
  EXPECT_THAT(exported("json", {"-o", archive()}).err, HasSubstr("is read by this command"));
  EXPECT_EQ(exported("c", {"-o", file("robot.txt").string()}).status, 2);
  EXPECT_EQ(exported("c", {"-o", file("a b.c").string()}).status, 2);
  EXPECT_EQ(left_behind().size(), 3u);
}

TEST_F(Export, RefusesABankWhoseUncertaintyIsFoundFalse) {
  for (const Calibration verdict : {Calibration::overconfident, Calibration::underconfident}) {
    judge(verdict);
    for (const std::string form : {"json", "c"}) {
      const ProgramResult result = exported(form, {"-o", file("refused.c").string()});
      EXPECT_EQ(result.status, 1) << form;
      EXPECT_THAT(result.err, HasSubstr(std::string(name_of(verdict))));
      EXPECT_THAT(result.err, HasSubstr("--force"));
      EXPECT_FALSE(std::filesystem::exists(file("refused.c")));
    }
    const ProgramResult forced = exported("json", {"--force"});
    EXPECT_EQ(forced.status, 0);
    EXPECT_EQ(json::parse(forced.out).at("verdict").at("answer"), name_of(verdict));
  }
}

TEST_F(Export, TakesTheFilterAsItWasJudged) {
  judge(Calibration::calibrated);
  EXPECT_THAT(exported("json", {"--filter.variant", "kf"}).err, HasSubstr("export does not read --filter.variant"));
  const ProgramResult baseline = exported("json", {"--track.filter", "baseline"});
  ASSERT_EQ(baseline.status, 0) << baseline.err;
  EXPECT_EQ(json::parse(baseline.out).at("source").at("filter"), "baseline");
  EXPECT_EQ(json::parse(baseline.out).at("filter").at("variant"), "kf");
  EXPECT_EQ(exported("json", {"--track.filter", "drifting"}).status, 2);
  EXPECT_EQ(exported("pdf").status, 2);
  EXPECT_EQ(modebank({"export", archive()}).status, 2);
  EXPECT_EQ(modebank({"show", archive(), "--to", "json"}).status, 2);
}

}  // namespace
}  // namespace modebank::test
