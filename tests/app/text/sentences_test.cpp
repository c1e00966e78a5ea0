// Sentences on random rows. This file states their meaning, which must agree with the numbers.
#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <random>
#include <regex>

#include "app/text/calibration_text.hpp"
#include "app/text/finding_text.hpp"
#include "app/text/response_text.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank::test {
namespace {

struct Draw {
  std::mt19937_64 generator;
  double normal(double sd) { return boost::random::normal_distribution<double>(0.0, sd)(generator); }
  double between(double least, double most) {
    return boost::random::uniform_real_distribution<double>(least, most)(generator);
  }
  int whole(int least, int most) { return boost::random::uniform_int_distribution<int>(least, most)(generator); }
};

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

/// Errors relative to the stated errors, with random tails, middle and NIS.
DiagnosticsRow random_row(Draw& draw) {
  const int samples = draw.whole(0, 1) == 0 ? draw.whole(20, 400) : draw.whole(2000, 9000);
  const double size = draw.between(0.8, 1.2), rough = draw.between(0.0, 0.1), quiet = draw.between(0.0, 0.2);
  const double nis = draw.whole(0, 2) == 0 ? draw.between(0.7, 1.4) : 1.0;
  std::vector<double> scores;
  for (int k = 0; k < samples; ++k) {
    const double u = draw.between(0.0, 1.0);
    scores.push_back(draw.normal(size) * (u < rough ? 2.0 : u < rough + quiet ? 0.3 : 1.0));
  }
  return row_of({scores}, true, nis);
}

TEST(Sentences, OnTheBandMeanWhatItsRowSays) {
  Draw draw{std::mt19937_64(3)};
  std::array<int, 4> verdicts{};
  for (int i = 0; i < 1600; ++i) {
    const DiagnosticsRow row = random_row(draw);
    const std::string text = app::band_text(row, {});
    ++verdicts[static_cast<std::size_t>(row.verdict)];
    const auto means = [&](const std::string& words, bool holds) { EXPECT_TRUE(!has(text, words) || holds) << text; };
    const bool covered = row.coverage_95 >= 0.925 && row.coverage_95 <= 0.975;
    means(": calibrated (", covered && row.nis_mean >= 0.75 && row.nis_mean <= 1.3);
    means(": undecided, mean NIS", covered && (row.nis_mean < 0.75 || row.nis_mean > 1.3));
    means("band is too narrow", row.coverage_95_upper < 0.95);
    means("band is too wide", row.coverage_95_lower > 0.95);
    means("errors are larger than stated", row.nis_mean > 1.1);
    means("errors are smaller than stated", row.nis_mean < 0.9);
    means("as close to the prediction", row.too_close < 0.01 || row.too_close > 0.04);
    means("too few independent samples",
          row.coverage_95_upper - row.coverage_95_lower > 0.05 || row.too_close_upper - row.too_close_lower > 0.03);
    means("chance may explain", !covered);
    EXPECT_EQ(has(row.flags, "too few samples"), has(text, "too few independent samples")) << row.flags;
  }
  for (const int count : verdicts) EXPECT_GT(count, 10);
}

/// An oscillator of damping 0.4 exceeds the end of a step by exp(-pi 0.4 / sqrt(1 - 0.4^2)) = 25 %, which an input that
/// creeps does not show. A gain of 0.1 +- 0.1 is no value, only a limit of 0.3.
TEST(Sentences, OnAStepTellWhatTheLogShows) {
  const double omega = 0.1, damping = 0.4, angle = omega * std::sqrt(1.0 - damping * damping);
  const double a1 = 2.0 * std::exp(-damping * omega) * std::cos(angle), a2 = -std::exp(-2.0 * damping * omega);
  const auto words = [&](double gain, double error, double rise) {
    const Eigen::Vector3d scale(0.0, 0.0, 1.0 - a1 - a2), theta = gain * scale + Eigen::Vector3d(a1 - 1.0, a2, 0.0);
    Bank bank = one_mode_bank({1, 1, false, 2}, theta, Eigen::VectorXd::Ones(1));
    bank.modes.front().response =
        step_response(bank.structure, theta, (error * scale).cwiseAbs2().asDiagonal(), {1}, 1.0);
    Trajectory run;
    run.time_s = Eigen::VectorXd::LinSpaced(401, 0.0, 400.0);
    run.input = ((run.time_s.array() - 200.0) / rise).cwiseMin(1.0).cwiseMax(0.0).matrix().transpose();
    run.state = run.input;
    return app::response_words(bank, {{{"y", "m"}}, {{"u", "V"}}, {run}}, "s").front();
  };
  EXPECT_TRUE(std::regex_search(words(2.0, 1e-3, 0.5), std::regex(", within 5 % after .*, overshoot 25 %")));
  EXPECT_FALSE(has(words(2.0, 1e-3, 100.0), "5 %")) << words(2.0, 1e-3, 100.0);
  EXPECT_NEAR(std::stod(words(0.1, 0.1, 0.5).substr(std::string("y per u: within +-").size())), 0.3, 0.06);
}

/// Scores of the bank and its competitors. Each run has a random level and a few outliers.
std::vector<Densities> random_scores(Draw& draw) {
  std::vector<Densities> all{{"bank", {}}};
  for (const char* name : competitor_names) all.push_back({name, {}});
  const int runs = draw.whole(1, 14), samples = draw.whole(20, 300);
  for (Densities& filter : all) {
    const double level = draw.whole(0, 2) == 0 ? 0.0 : draw.normal(0.2), spread = draw.between(0.0, 0.2);
    for (int r = 0; r < runs; ++r) {
      const double of_run = level + draw.normal(spread) + (draw.whole(0, 20) == 0 ? draw.normal(3.0) : 0.0);
      filter.of_runs.push_back(Eigen::VectorXd::NullaryExpr(samples, [&] { return of_run + draw.normal(0.3); }));
    }
  }
  return all;
}

/// Mean gain of runs of the same length.
double mean_gain(const Densities& better, const Densities& other) {
  double sum = 0.0;
  for (std::size_t r = 0; r < better.of_runs.size(); ++r) sum += (better.of_runs[r] - other.of_runs[r]).mean();
  return sum / static_cast<double>(better.of_runs.size());
}

/// The text in the brackets of a pattern; empty if the pattern does not match.
std::string named(const std::string& text, const std::string& pattern) {
  std::smatch found;
  return std::regex_search(text, found, std::regex(pattern)) ? found[1].str() : "";
}

TEST(Sentences, OnTheGainsMeanWhatTheirRowsSay) {
  Draw draw{std::mt19937_64(4)};
  std::array<int, 6> answers{};
  for (int i = 0; i < 1600; ++i) {
    const std::vector<Densities> all = random_scores(draw);
    const Bank bank = example_bank(1, 1, 2);
    const Finding finding =
        judge_modes({bank, Role::test, all[0], {all.begin() + 1, all.end()}, {}, {}, {{"y", 0.0, 1.0}}, {}});
    const std::string text = finding_text(finding);
    ++answers[static_cast<std::size_t>(finding.answer)];
    const auto gain = [&](const std::string& name) {
      const auto scores = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.filter == name; });
      return mean_gain(all[0], *scores);
    };
    const auto margin = [&](const std::string& name) { return gain_over(finding, name)->margin; };
    const auto means = [&](bool said, auto holds) { EXPECT_TRUE(!said || holds()) << text; };
    EXPECT_FALSE(std::regex_search(text, std::regex("worse than")) && finding.gain >= 0.0) << text;
    const std::string best = named(text, "the best single model \\(`(\\w+)`");
    for (const char* name : competitor_names) {
      EXPECT_GE(gain(name), gain(best) - 1e-12) << text;
      means(text.starts_with("Switching between"),
            [&] { return gain(name) > std::max(margin(name), finding.gains[0].least_gain); });
    }
    const std::string unbeaten = named(text, "the gain over `(\\w+)`, .* may be chance");
    means(!unbeaten.empty(), [&] { return gain(unbeaten) <= margin(unbeaten); });
    means(has(text, "No evidence"), [&] {
      return std::any_of(finding.gains.begin(), finding.gains.end(),
                         [](const PairedGain& g) { return g.gain <= 0.0 || g.gain + g.margin < g.least_gain; });
    });
    const std::string of_unknown_error =
        named(text, "too few independent samples leave the error of the gain over `(\\w+)`");
    means(!of_unknown_error.empty(), [&] { return std::isnan(margin(of_unknown_error)); });
  }
  for (const Answer answer : {Answer::evidence, Answer::no_evidence, Answer::cannot_tell})
    EXPECT_GT(answers[static_cast<std::size_t>(answer)], 20) << name_of(answer);
}

}  // namespace
}  // namespace modebank::test
