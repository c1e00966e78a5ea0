// The screen at the end of a run: its size, its content, and a case for every rule on the next step.
#include "app/text/first_screen.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/cli/help_text.hpp"
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
using testing::Not;

const app::Settings defaults{
    {"window.model", "linear"}, {"window.state_lags", "1"}, {"filter.noise", "gaussian"}, {"mixture.restarts", "5"}};

std::string screen_of(const Archive& archive) { return first_screen(archive, defaults, "demo.h5"); }

void expect_fits(const Archive& archive, const std::string& what) {
  const std::string screen = screen_of(archive);
  std::istringstream stream(screen);
  int lines = 0;
  for (std::string line; std::getline(stream, line); ++lines)
    EXPECT_LE(app::columns_of(line), app::screen_columns) << what << ": " << line;
  EXPECT_LE(lines, app::screen_lines) << what << '\n' << screen;
  for (const char* label : {"read ", "finding ", "modes ", "band ", "mean ", "next ", "archive "})
    EXPECT_THAT("\n" + screen, HasSubstr(std::string("\n") + label)) << what;
  EXPECT_EQ(screen.find('\t'), std::string::npos) << what;
}

TEST(FirstScreen, NextNamesTheProgramAsItWasCalled) {
  const Archive archive = screen_archive(1, 2, 3);
  EXPECT_THAT(first_screen(archive, defaults, "demo.h5", 0, "build/modebank"),
              HasSubstr("ready: `build/modebank track demo.h5`"));
}

TEST(FirstScreen, SaysThatInputsAreNeededAhead) {
  const Archive archive = screen_archive(1, 2, 3);
  app::Settings settings = defaults;
  settings["data.lag_s"] = "0.25";
  EXPECT_THAT(first_screen(archive, settings, "demo.h5"), Not(HasSubstr("ahead of the states")));
  settings["data.lag_s"] = "-0.25";
  EXPECT_THAT(first_screen(archive, settings, "demo.h5"), HasSubstr("needs inputs 0.250 s ahead of the states"));
}

/// Adds the longest finding and the longest warning.
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

TEST(FirstScreen, SaysWhatMatters) {
  const std::string screen = screen_of(screen_archive(1, 2, 3));
  EXPECT_THAT(screen, AllOf(HasSubstr("1 training and 1 held-out run, 4 and 4 steps of 0.1 s; wz from vel0, vel1"),
                            HasSubstr("shows evidence for modes of motion"), HasSubstr("3 on held-out runs"),
                            HasSubstr("gains in (rad/s)/(m/s)"), HasSubstr("wz per vel1"),
                            HasSubstr("96.6 % [95.6, 97.4] of the held-out samples lie in the 95 % band: calibrated")));
  EXPECT_THAT(screen,
              AllOf(HasSubstr("RMSE one step ahead 0.03 rad/s (drifting: 0.04 rad/s); 10 steps ahead 0.06 rad/s\n"),
                    HasSubstr("(drifting: 0.08 rad/s)\n"),
                    HasSubstr("1.2 s"),  // 12 samples of 0.1 s
                    HasSubstr("ready: `modebank track"), HasSubstr("archive   demo.h5"), Not(HasSubstr("warning"))));
  EXPECT_THAT(screen_of(screen_archive(1, 2, 3, Role::train)), HasSubstr("none held out"));
}

/// The best of log score need not be the best of the mean: what stands beside the bank's error is what the finding
/// names.
TEST(FirstScreen, ErrorsStandBesideTheLeastOfTheCompetitors) {
  Archive archive = screen_archive(2, 1, 3);
  SummaryRow row = archive.summary.back();
  row.filter = "baseline";
  row.rmse = Eigen::Vector2d(0.035, 0.05);
  archive.summary.push_back(row);
  EXPECT_THAT(app::make_first_screen(archive, defaults).mean,
              HasSubstr("(wz 0.035 rad/s (baseline), v1 0.04 rad/s (drifting))"));
}

TEST(FirstScreen, StaysAreThoseOfTheTransitionMatrixWhereGapsCutRuns) {
  Archive archive = screen_archive(1, 1, 2);
  archive.recording->runs.front().state = Eigen::MatrixXd::Zero(1, 300);
  for (DiagnosticsRow& row : archive.diagnostics) row.dwell_model = row.mode == 0 ? 169.0 : 1000.0;
  EXPECT_THAT(screen_of(archive), AllOf(HasSubstr("16.9 s"), HasSubstr("over 30 s")));
}

TEST(FirstScreen, SaysWhatTheFiltersPredictTogether) {
  Archive archive = screen_archive(1, 2, 3);
  archive.summary.push_back(archive.summary.back());
  archive.summary.back().filter = "combined";
  archive.summary.back().rmse.setConstant(0.02);
  archive.horizons.push_back({"combined", Role::test, "*", 10, 100, 0.0, Eigen::VectorXd::Constant(1, 0.05)});
  EXPECT_THAT(screen_of(archive), AllOf(HasSubstr("0.03 rad/s (drifting: 0.04 rad/s, combined: 0.02 rad/s)"),
                                        HasSubstr("(drifting: 0.08 rad/s, combined: 0.05 rad/s)")));
}

/// Training runs that were left out decide; judged runs give the gain.
TEST(FirstScreen, EndsInWhatToUnderstandAndWhatToPredictWith) {
  Archive archive = screen_archive(1, 2, 3);
  const Eigen::VectorXd rmse = Eigen::VectorXd::Constant(1, 0.03);
  for (const Index steps : {1, 10}) {
    archive.left_out.push_back({"bank", steps, 100, 1.0, rmse, 0.5});
    archive.left_out.push_back({"drifting", steps, 100, steps == 1 ? 0.9 : 1.2, rmse, 0.5});
    archive.left_out.push_back({"combined", steps, 100, steps == 1 ? 1.05 : 1.2, rmse, not_a_number});
  }
  for (const char* run : {"01", "02"})
    for (const char* filter : {"bank", "combined"}) {
      SummaryRow row = archive.summary.front();
      row.filter = filter;
      row.run = run;
      row.samples = 100;
      row.log_score = std::string(filter) == "bank" ? 1.0 : std::string(run) == "01" ? 1.1 : 1.3;
      archive.summary.push_back(row);
    }
  const std::vector<app::NamedForecast> named = app::named_forecasts(archive);
  ASSERT_EQ(named.size(), 2);
  EXPECT_EQ(named[0].filter, "combined");
  EXPECT_EQ(named[0].other, "bank");
  EXPECT_NEAR(named[0].gain, 0.2, 1e-12);
  EXPECT_NEAR(named[0].error, 0.1, 1e-12);  // from 0.1 and 0.3 in runs of equal length
  EXPECT_EQ(named[0].c_filter, "bank");
  EXPECT_NEAR(named[0].c_loss, 0.2, 1e-12);
  EXPECT_EQ(named[1].steps, 10);
  EXPECT_EQ(named[1].filter, "drifting");  // as good as combined, and a single filter
  EXPECT_THAT(app::use_words(archive),
              testing::StartsWith("to understand: the bank of 3 modes; to predict 1 step: `--track.filter combined`, "
                                  "+0.200 +- 0.100 nats over bank, in C bank (-0.200); 10 steps: "
                                  "`--track.filter drifting`"));
  // Any gain over all single filters makes it the combination; among these, where they differ by less than 0.02 nats,
  // the error chooses.
  archive.left_out[0].log_score = 1.04;
  EXPECT_EQ(app::named_forecasts(archive)[0].filter, "combined");
  archive.left_out[0].log_score = 1.049;
  EXPECT_EQ(app::named_forecasts(archive)[0].filter, "bank");
  archive.left_out[2].log_score = 1.04;  // drifting's score one step ahead is below bank's
  archive.left_out[1].log_score = 1.035;
  archive.left_out[0].rmse *= 1.1;
  EXPECT_EQ(app::named_forecasts(archive)[0].filter, "drifting");
}

/// The filter with the best density may have a larger error than another one: 0.024 in place of 0.03 saves a fifth.
TEST(FirstScreen, NamesTheFilterOfLeastErrorWhereItIsAnother) {
  Archive archive = screen_archive(1, 2, 3);
  const Eigen::VectorXd rmse = Eigen::VectorXd::Constant(1, 0.03);
  archive.left_out.push_back({"bank", 1, 100, 1.0, rmse, 0.5});
  archive.left_out.push_back({"nonlinear", 1, 100, 0.5, 0.99 * rmse, 0.5});
  EXPECT_EQ(app::named_forecasts(archive)[0].point_filter, "bank");  // 1 % is below the differences between runs
  EXPECT_EQ(app::named_forecasts(archive)[0].point_gain, 0.0);
  archive.left_out.back().rmse = 0.8 * rmse;
  const app::NamedForecast named = app::named_forecasts(archive)[0];
  EXPECT_EQ(named.filter, "bank");
  EXPECT_EQ(named.point_filter, "nonlinear");
  EXPECT_NEAR(named.point_gain, 0.2, 1e-12);
  EXPECT_THAT(app::use_words(archive), testing::EndsWith("; least error 1 step: nonlinear (-20 %)"));
}

/// 0.5, 0.3, 0.18, ... falls below a hundredth after the eighth. Page and terminal both take their text from this
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
  EXPECT_EQ(screen.errors[1].bank(0), 0.06);
  EXPECT_EQ(screen.errors[1].other(0), 0.08);
  EXPECT_EQ(screen.free_run_start, 0);
  EXPECT_EQ(screen.mode_count, 3);
  EXPECT_EQ(screen.modes.gain_unit, "(rad/s)/(m/s)");
  ASSERT_EQ(screen.modes.rows.size(), 3u);
  EXPECT_EQ(screen.modes.rows[0].cells.size(), screen.modes.headings.size());
  const std::string text = screen_of(archive);
  std::string as_one_line = text;
  std::replace(as_one_line.begin(), as_one_line.end(), '\n', ' ');
  for (const std::string& said : {screen.finding, screen.modes.rows[0].cells[4]})
    EXPECT_THAT(as_one_line, HasSubstr(said));
  EXPECT_EQ(screen.next, "ready: `modebank track ARCHIVE` filters samples as they come");
  EXPECT_THAT(as_one_line, HasSubstr("ready: `modebank track demo.h5` filters")) << "as it can be typed";
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
  EXPECT_EQ(screen.errors[0].other.size(), 1) << "errors are known without a finding";
  EXPECT_EQ(app::make_first_screen(Archive{}, {}).mode_count, 0);
}

TEST(FirstScreen, ItsModesAreAtMostEightAndTheOthersAddUp) {
  const app::FirstScreen screen = app::make_first_screen(screen_archive(1, 1, 20), defaults);
  ASSERT_EQ(screen.modes.rows.size(), 8u);
  EXPECT_EQ(screen.modes.rows[0].mode, 0);
  EXPECT_EQ(screen.modes.others, 12);
  EXPECT_NEAR(screen.modes.others_use, 0.5 * (std::pow(0.6, 8) - std::pow(0.6, 20)) / 0.4, 1e-12);
}

TEST(FirstScreen, FoldsModesThatAreHardlyUsed) {
  EXPECT_THAT(screen_of(screen_archive(1, 1, 20)), HasSubstr("and 12 others, used 2.1 %"));
  EXPECT_THAT(screen_of(screen_archive(1, 1, 3)), Not(HasSubstr("other")));
  Archive archive = screen_archive(1, 1, 3);
  for (DiagnosticsRow& row : archive.diagnostics)
    if (row.mode == 1) row.usage = 0.004;
  EXPECT_THAT(screen_of(archive), HasSubstr("and 1 other, used 0.4 %"));
}

TEST(FirstScreen, WarningsAreCountedAndTheFirstIsTold) {
  const std::string screen = screen_of(talkative(screen_archive(1, 2, 3)));
  EXPECT_THAT(screen, AllOf(HasSubstr("warning "), HasSubstr("the first: "), HasSubstr("0 of 5 restarts")));
}

/// Terms that the glossary of `help` and of the page must contain.
TEST(FirstScreen, ItsTermsHaveAMeaning) {
  for (const char* term :
       {"evidence", "mode",      "bank",       "drifting",      "competitor",    "nats",   "held-out",
        "step",     "used",      "stay",       "decay/sample",  "time constant", "period", "steady gain",
        "band",     "95 % band", "calibrated", "overconfident", "RMSE",          "+-"})
    EXPECT_FALSE(app::help_on(term).empty()) << term;
}

struct NextStep : testing::Test {
  Archive archive = screen_archive(1, 2, 3);
  app::Settings settings = defaults;
  DiagnosticsRow& row() { return archive.diagnostics.front(); }
  std::string advice() const { return app::next_step(archive, settings); }
};

TEST_F(NextStep, NothingIsLeft) { EXPECT_THAT(advice(), HasSubstr("ready: `modebank track")); }

TEST_F(NextStep, WhatIsNotScoredHasNone) {
  archive.finding.reset();
  EXPECT_EQ(advice(), "");
}

TEST_F(NextStep, LostWindowsComeFirst) {
  archive.windows.emplace();
  archive.windows->status = Eigen::VectorXi::Constant(1, static_cast<int>(FitStatus::failed));
  archive.finding->answer = Answer::not_comparable;
  EXPECT_THAT(advice(), HasSubstr("no finite fit"));
}

TEST_F(NextStep, AnswersHaveTheirs) {
  archive.finding->answer = Answer::not_yet;
  EXPECT_THAT(advice(), HasSubstr("log at even steps"));
  archive.finding->answer = Answer::not_comparable;
  EXPECT_THAT(advice(), AllOf(HasSubstr("modebank check"), HasSubstr("data.rate_hz")));
  archive.finding->answer = Answer::cannot_tell;
  EXPECT_THAT(advice(), AllOf(HasSubstr("record more: longer runs, and more than 1"), HasSubstr("--data.test")));
  archive.finding->role = Role::train;
  EXPECT_THAT(advice(), HasSubstr("hold runs out"));
  archive.recording.emplace().runs.resize(1);
  archive.recording->runs.front().state = Eigen::MatrixXd::Zero(1, 4000);
  EXPECT_THAT(advice(), HasSubstr("--data.split 'blocks 10'")) << "one run alone";
  archive.finding->role = Role::test;
  archive.finding->answer = Answer::no_evidence;
  archive.finding->better_description = "one_motion";
  archive.finding->best_competitor = "one_motion";
  EXPECT_THAT(advice(), HasSubstr("use the simpler one_motion (one motion with changing noise): `modebank track"));
  archive.finding->best_competitor = "drifting";
  EXPECT_THAT(advice(), HasSubstr("(one motion with changing noise), which is about as good as drifting: `modebank"));
}

TEST_F(NextStep, APatternInErrorsAsksForMemory) {
  archive.finding->answer = Answer::not_yet;
  archive.finding->pattern = {0.12, 0.015};
  EXPECT_THAT(advice(), AllOf(HasSubstr("--window.model auto"), Not(HasSubstr("even"))));
  settings["window.model"] = "auto";
  EXPECT_THAT(advice(), AllOf(HasSubstr("--data.lag_s auto"), Not(HasSubstr("window.model"))));
  settings["data.lag_s"] = "auto";
  EXPECT_THAT(advice(), testing::StartsWith("ready")) << "what was tried is not advised again";
  settings.erase("window.model");
  archive.finding->answer = Answer::one_mode;
  EXPECT_THAT(advice(), HasSubstr("--window.model auto")) << "one linear model lacks lags, too";
}

/// After a search for lags, or with coloured errors on held-out runs only, lags are not the cause.
TEST_F(NextStep, ColouredErrorsWithoutAPatternAskForACheck) {
  row().whiteness_p = 1e-6;
  row().autocorrelation = -0.92;
  EXPECT_THAT(advice(), AllOf(HasSubstr("modebank check"), Not(HasSubstr("window.model"))));
  archive.finding->answer = Answer::no_evidence;
  archive.finding->better_description = "one_motion";
  EXPECT_THAT(advice(), HasSubstr("use the simpler one_motion"));
}

TEST_F(NextStep, AFalseBandAsksForAdaptiveNoiseOnce) {
  for (const Calibration verdict : {Calibration::overconfident, Calibration::underconfident}) {
    row().verdict = verdict;
    settings["filter.noise"] = "gaussian";
    EXPECT_THAT(advice(), HasSubstr("--filter.noise adaptive"));
    settings["filter.noise"] = "adaptive";
    EXPECT_THAT(advice(), AllOf(HasSubstr("--data.train"), Not(HasSubstr("adaptive"))));
  }
  row().verdict = Calibration::undecided;
  row().coverage_95_lower = 0.9, row().coverage_95_upper = 0.99;
  EXPECT_THAT(advice(), HasSubstr("record more: held-out samples"));
}

/// The numbers behind a flag decide, not its words.
TEST_F(NextStep, GoesByNumbersAndNotByWords) {
  row().flags = "innovations not white: autocorrelation 0.45 at lag 1";
  EXPECT_THAT(advice(), HasSubstr("ready: `modebank track"));
}

TEST_F(NextStep, UnknownErrorsAskForThem) {
  archive.finding->answer = Answer::cannot_tell;
  archive.finding->gains = {{"drifting", 700, 0.3, 0.1, 5.0, 0.2, false}};
  EXPECT_THAT(advice(), HasSubstr("inputs that hardly vary"));
  settings["bank.look_ahead"] = "10";
  EXPECT_THAT(advice(), HasSubstr("--bank.look_ahead 1"));
}

/// A gain of half its required size needs four times the runs: margins fall as 1 / sqrt(runs).
TEST_F(NextStep, ADoubtfulGainAsksForSoManyRuns) {
  archive.finding->answer = Answer::cannot_tell;
  archive.finding->modes_differ = true;
  archive.finding->runs = 6;
  archive.finding->gains = {{"drifting", 700, 0.1, 0.08, 5.0, 0.2, false}};
  EXPECT_THAT(advice(), HasSubstr("record more: about 18 more runs like these, by which the gain over drifting"));
  archive.finding->gains[0].margin = 0.5;
  EXPECT_THAT(advice(), HasSubstr("the data cannot tell"));
  archive.finding->gains[0] = {"drifting", 700, 0.01, 0.001, 5.0, 0.003, false, 0.01};
  EXPECT_THAT(advice(), HasSubstr("ready: use the simpler drifting"));
  archive.finding->gains[0].gain = 0.1;
  archive.finding->stay = 2.0;
  archive.finding->stay_asked = 5.0;
  EXPECT_THAT(advice(), HasSubstr("the data cannot tell: modes so short"));
}

TEST_F(NextStep, RoundedValuesAreNotAskedForTwice) {
  archive.finding->answer = Answer::not_comparable;
  EXPECT_THAT(advice(), HasSubstr("--data.quantum auto"));
  settings["data.quantum"] = "auto";
  EXPECT_THAT(advice(), Not(HasSubstr("--data.quantum")));
}

TEST_F(NextStep, DataWithoutNoiseLeaveNothingToFilter) {
  archive.finding->answer = Answer::one_mode;
  archive.finding->without_noise = true;
  EXPECT_THAT(advice(), HasSubstr("modebank export ARCHIVE --to json"));
}

TEST_F(NextStep, ABankWithoutAStableModeWarns) {
  for (Mode& mode : archive.bank->modes) mode.model.A(0, 0) = 0.01;
  EXPECT_THAT(app::archive_warnings(archive),
              ElementsAre(testing::Field(&app::Warning::text,
                                         HasSubstr("no mode of the bank is stable (spectral radius 1.01)"))));
  EXPECT_THAT(advice(), HasSubstr("leave out of --data.state"));
  archive.bank->modes.back().model.A(0, 0) = -0.2;
  EXPECT_THAT(app::archive_warnings(archive), IsEmpty());
}

/// A warning takes precedence over advice on use.
TEST_F(NextStep, WarningsComeBeforeUse) {
  archive.mixture.emplace();
  archive.mixture->candidates.resize(1);
  archive.mixture->candidates[0].selected = true;
  archive.mixture->candidates[0].restarts = 5;
  EXPECT_THAT(advice(), HasSubstr("--mixture.restarts 20"));
  settings["mixture.restarts"] = "20";
  EXPECT_THAT(advice(), Not(HasSubstr("--mixture.restarts")));
  archive.unrefined = archive.bank;
  EXPECT_THAT(advice(), HasSubstr("ready: `modebank track")) << "refinement replaced the mixture";
  archive.unrefined.reset();
  archive.mixture->candidates[0].agreeing_restarts = 5;
  archive.mixture->candidates[0].converged = true;
  EXPECT_THAT(advice(), HasSubstr("ready: `modebank track"));
  archive.mixture->candidates[0].floor_active = true;
  EXPECT_THAT(advice(), AllOf(HasSubstr("--mixture.components"), Not(HasSubstr("ready"))));
  archive.measured_fit = MeasuredFit::iteration_limit;
  EXPECT_THAT(advice(), HasSubstr("--bank.measurement_variance VARIANCE"));
}

}  // namespace
}  // namespace modebank::test
