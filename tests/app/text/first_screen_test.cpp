// The screen at the end of a run: its size and its content.
#include "app/text/first_screen.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "app/text/terminal.hpp"
#include "app/text/warnings.hpp"
#include "tests/app/text/screen_archive.hpp"

namespace modebank::test {
namespace {

using app::first_screen;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const app::Settings defaults{{"window.model", "linear"}, {"window.state_lags", "1"}, {"mixture.restarts", "5"}};

std::string screen_of(const Archive& archive) { return first_screen(archive, defaults, "demo.h5"); }

void expect_fits(const Archive& archive, const std::string& what) {
  const std::string screen = screen_of(archive);
  std::istringstream stream(screen);
  int lines = 0;
  for (std::string line; std::getline(stream, line); ++lines)
    EXPECT_LE(app::columns_of(line), app::screen_columns) << what << ": " << line;
  EXPECT_LE(lines, app::screen_lines) << what << '\n' << screen;
  for (const char* label : {"read ", "finding ", "modes ", "band ", "mean ", "archive "})
    EXPECT_THAT("\n" + screen, HasSubstr(std::string("\n") + label)) << what;
  EXPECT_EQ(screen.find('\t'), std::string::npos) << what;
}

std::string as_one_line(std::string text) {
  std::string line;
  for (const std::string& part : app::lines_of(text)) line += (line.empty() ? "" : " ") + part;
  for (std::size_t at; (at = line.find("  ")) != std::string::npos;) line.erase(at, 1);
  return line;
}

/// Adds the longest finding and the longest warning to an archive.
Archive talkative(Archive archive) {
  for (int i = 0; i < 200; ++i) archive.finding->text += " And another word.";
  MixtureResult mixture;
  mixture.candidates.resize(3);
  for (Candidate& candidate : mixture.candidates) candidate.restarts = 5;
  mixture.candidates.back().selected = true;
  archive.mixture = mixture;
  archive.measured_fit = MeasuredFit::stalled;
  return archive;
}

Archive with_names(Archive archive, const std::string& name, const std::string& unit) {
  for (Channel& state : archive.recording->states) state = {name + state.name, unit};
  for (Channel& input : archive.recording->inputs) input = {name + input.name, unit};
  return archive;
}

TEST(FirstScreen, FitsWhateverTheArchiveHolds) {
  for (const auto& [states, inputs, modes] :
       {std::array<Index, 3>{1, 2, 8}, {1, 2, 1}, {1, 2, 20}, {2, 2, 5}, {4, 6, 9}, {1, 0, 3}}) {
    const Archive archive = screen_archive(states, inputs, modes);
    const std::string what = std::to_string(states) + ", " + std::to_string(inputs) + ", " + std::to_string(modes);
    expect_fits(archive, what);
    expect_fits(talkative(archive), what + " talkative");
    expect_fits(screen_archive(states, inputs, modes, Role::train), what + ", nothing held out");
    const std::string words = "a very long name of a channel with words ", word(120, 'w');
    for (const std::string& name :
         {words, word, std::string("Längsgeschwindigkeit ä<b>\"{}%s\t "), std::string("[k-1]")})
      expect_fits(talkative(with_names(archive, name, name)), what + " " + name);
  }
}

/// The RMSE is 0.03, and the measurements have a mean square deviation of 0.01 from their mean. FIT = 100 (1 - 0.03 /
/// 0.1) = 70. The first sample of each run cannot be predicted, so it does not count. Training runs do not count
/// either.
TEST(FirstScreen, FitIsThatOfMatlab) {
  Archive archive = screen_archive(1, 1, 2);
  for (Trajectory& run : archive.recording->runs) run.state.row(0) << 9.0, 1.1, 0.9, 1.1, 0.9;
  archive.recording->runs.front().state *= 7.0;
  const app::FirstScreen screen = app::make_first_screen(archive, defaults);
  ASSERT_EQ(screen.errors[0].fit_percent.size(), 1);
  EXPECT_NEAR(screen.errors[0].fit_percent(0), 70.0, 1e-9);
  EXPECT_THAT(screen.mean, HasSubstr("0.03 rad/s (1.72 deg/s), FIT 70.0 %"));
  EXPECT_EQ(screen.errors[1].fit_percent.size(), 0) << "no sample is 10 steps from the beginning";
}

TEST(FirstScreen, StaysAreThoseOfTheTransitionMatrixWhereGapsCutRuns) {
  Archive archive = screen_archive(1, 1, 2);
  archive.recording->runs.front().state = Eigen::MatrixXd::Zero(1, 300);
  for (DiagnosticsRow& row : archive.diagnostics) row.dwell_model = row.mode == 0 ? 169.0 : 1000.0;
  EXPECT_THAT(screen_of(archive), AllOf(HasSubstr("16.9 s"), HasSubstr("over 30 s")));
}

/// Predictions of training runs left out decide. The judged runs give the errors.
TEST(FirstScreen, EndsInWhatToUnderstandAndWhatToPredictWith) {
  Archive archive = screen_archive(1, 2, 3);
  const Eigen::VectorXd rmse = Eigen::VectorXd::Constant(1, 0.03);
  for (const Index steps : {1, 10}) {
    archive.left_out.push_back({"bank", steps, 100, 1.0, rmse, 0.5});
    archive.left_out.push_back({"drifting", steps, 100, steps == 1 ? 0.9 : 1.2, rmse, 0.5});
    archive.left_out.push_back({"combined", steps, 100, steps == 1 ? 1.05 : 1.2, rmse, not_a_number});
  }
  for (SummaryRow& row : archive.summary) row.log_score = row.filter == "bank" ? 1.0 : 0.9;
  archive.summary.push_back(archive.summary.front());
  archive.summary.back().filter = "combined";
  archive.summary.back().log_score = 1.2;
  archive.drifting = archive.bank;
  archive.drifting->running_noise.floor.setOnes(1);  // learns in every run, which the C code does not
  const std::vector<app::NamedForecast> named = app::named_forecasts(archive);
  ASSERT_EQ(named.size(), 2);
  EXPECT_EQ(named[0].filter, "combined");
  EXPECT_EQ(named[0].c_filter, "bank");
  EXPECT_EQ(named[1].steps, 10);
  EXPECT_EQ(named[1].filter, "drifting");  // as good as the combination, but a single filter
  EXPECT_EQ(named[1].c_filter, "bank");
  EXPECT_EQ(named[1].rmse(0), 0.08);
  // The simplest filter that loses less than 0.02 nats is named. Its error does not count.
  archive.left_out[0].log_score = 1.029;
  EXPECT_EQ(app::named_forecasts(archive)[0].filter, "combined");
  archive.left_out[0].log_score = 1.031;
  EXPECT_EQ(app::named_forecasts(archive)[0].filter, "bank");
  archive.finding->better_description = "drifting";  // held-out runs do not tell the two apart
  EXPECT_EQ(app::named_forecasts(archive)[0].filter, "drifting");
}

/// The uses 0.5, 0.3, 0.18, ... fall below 0.01 after the eighth mode. Page and terminal both take their text from this
/// struct.
TEST(FirstScreen, ItsFieldsAreTheArchivesNumbers) {
  Archive archive = screen_archive(1, 2, 3);
  archive.finding->gain = 0.187;
  archive.finding->standard_error = 0.057;
  const app::FirstScreen screen = app::make_first_screen(archive, defaults);
  EXPECT_EQ(screen.answer, Answer::evidence);
  EXPECT_EQ(screen.competitor, "drifting");
  EXPECT_EQ(screen.gain, 0.187);
  EXPECT_EQ(screen.gain_error, 0.057);
  EXPECT_EQ(screen.coverage, 0.966);
  EXPECT_EQ(screen.coverage_lower, 0.956);
  EXPECT_EQ(screen.coverage_upper, 0.974);
  EXPECT_EQ(screen.verdict, Calibration::calibrated);
  ASSERT_EQ(screen.errors.size(), 2u);
  EXPECT_EQ(screen.errors[0].steps, 1);
  EXPECT_EQ(screen.errors[1].steps, 10);
  EXPECT_EQ(screen.errors[1].rmse(0), 0.06);
  EXPECT_EQ(screen.free_run_start, 0);
  EXPECT_EQ(screen.mode_count, 3);
  EXPECT_EQ(screen.modes.gain_unit, "(rad/s)/(m/s)");
  ASSERT_EQ(screen.modes.rows.size(), 3u);
  EXPECT_EQ(screen.modes.rows[0].cells.size(), screen.modes.headings.size());
  const std::string text = as_one_line(screen_of(archive));
  for (const std::string& said : {screen.finding, screen.modes.rows[0].cells[3]}) EXPECT_THAT(text, HasSubstr(said));
}

TEST(FirstScreen, WhatIsNotKnownIsNoNumber) {
  Archive archive = screen_archive(1, 1, 1);
  archive.finding->best_competitor.clear();
  archive.diagnostics.clear();
  const app::FirstScreen screen = app::make_first_screen(archive, defaults);
  EXPECT_TRUE(std::isnan(screen.gain));
  EXPECT_TRUE(std::isnan(screen.coverage));
  EXPECT_EQ(screen.band, "");
  ASSERT_EQ(screen.errors.size(), 2u);
  EXPECT_EQ(screen.errors[0].rmse.size(), 1) << "errors are known without a finding";
  EXPECT_EQ(app::make_first_screen(Archive{}, {}).mode_count, 0);
}

TEST(FirstScreen, ItsModesAreAtMostEightAndTheOthersAddUp) {
  const app::FirstScreen screen = app::make_first_screen(screen_archive(1, 1, 20), defaults);
  ASSERT_EQ(screen.modes.rows.size(), 8u);
  EXPECT_EQ(screen.modes.rows[0].modes, std::vector<Index>{0});
  EXPECT_EQ(screen.modes.others, 12);
  EXPECT_NEAR(screen.modes.others_use, 0.5 * (std::pow(0.6, 8) - std::pow(0.6, 20)) / 0.4, 1e-12);
}

TEST(Warnings, ABankWithoutAStableModeWarns) {
  Archive archive = screen_archive(1, 2, 3);
  for (Mode& mode : archive.bank->modes) mode.model.A(0, 0) = 0.01;
  EXPECT_THAT(app::archive_warnings(archive),
              ElementsAre(HasSubstr("no mode of the bank is stable (spectral radius 1.01)")));
  archive.bank->modes.back().model.A(0, 0) = -0.2;
  EXPECT_THAT(app::archive_warnings(archive), IsEmpty());
}

}  // namespace
}  // namespace modebank::test
