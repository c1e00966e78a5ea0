#include "filter/judge/scores.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "filter/judge/diagnostics.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Sums over scored samples of one or more runs. A sample is scored by its available signals.
struct ScoreSums {
  Index samples = 0, nis_above = 0, nis_below = 0;
  double log_density = 0.0;
  Eigen::ArrayXd squared_error, errors;
  BandCounts counts;
  std::vector<double> pit, whiteness;

  void add(const RunEvaluation& run, const RunScores& scores) {
    if (errors.size() == 0) squared_error = errors = Eigen::ArrayXd::Zero(run.innovation.rows());
    counts.begin_run(run);
    for (Index k = 0; k < run.log_density.size(); ++k)
      if (!std::isnan(run.log_density(k))) add_sample(run, k, scores);
    whiteness.push_back(scores.whiteness_p);
  }

  SummaryRow row() const {
    SummaryRow row;
    const double N = samples > 0 ? static_cast<double>(samples) : not_a_number;
    row.samples = samples;
    row.log_score = log_density / N;
    row.rmse = (squared_error / errors).sqrt();
    row.nis_mean = mean_distance(counts.nis, static_cast<double>(errors.size()));
    row.nis_above = static_cast<double>(nis_above) / N;
    row.nis_below = static_cast<double>(nis_below) / N;
    row.too_far = share_of(counts.far);
    row.too_close = share_of(counts.close);
    row.coverage_50 = 1.0 - share_of(counts.outside[0]);
    row.coverage_90 = 1.0 - share_of(counts.outside[1]);
    row.coverage_95 = 1.0 - share_of(counts.outside[2]);
    row.coverage_99 = 1.0 - share_of(counts.outside[3]);
    row.pit_distance = kolmogorov_distance(pit);
    row.whiteness_p = fisher_p(whiteness);
    return row;
  }

 private:
  std::vector<Interval> nis_tails_;  ///< limits of the tails for one signal, two signals, ...

  void add_sample(const RunEvaluation& run, Index k, const RunScores& scores) {
    ++samples;
    log_density += run.log_density(k);
    const auto there = (!run.pit.col(k).array().isNaN()).eval();
    squared_error += there.select(run.innovation.col(k).array().square(), 0.0);
    errors += there.cast<double>();
    counts.add(run, scores, k);
    for (Index i = 0; i < there.size(); ++i)
      if (there(i)) pit.push_back(run.pit(i, k));
    while (std::ssize(nis_tails_) < there.size()) {
      const double degrees = static_cast<double>(nis_tails_.size() + 1);
      nis_tails_.push_back({chi_square_quantile(true_tail, degrees), chi_square_quantile(1.0 - true_tail, degrees)});
    }
    if (!there.any()) return;
    const Interval& tails = nis_tails_[static_cast<std::size_t>(there.count() - 1)];
    nis_above += run.nis(k) > tails.upper;
    nis_below += run.nis(k) < tails.lower;
  }
};

}  // namespace

std::vector<SummaryRow> summarize(const std::string& filter, Role role, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores) {
  if (runs.size() != evaluations.size() || runs.size() != scores.size())
    throw std::invalid_argument(std::to_string(runs.size()) + " runs, but " + std::to_string(evaluations.size()) +
                                " evaluations and " + std::to_string(scores.size()) + " of them scored");
  std::vector<SummaryRow> rows;
  sum_runs<ScoreSums>(
      runs, role, [&](std::size_t i, ScoreSums& sums) { sums.add(evaluations[i], scores[i]); },
      [&](const ScoreSums& sums, const std::string& run) {
        rows.push_back(sums.row());
        rows.back().filter = filter;
        rows.back().role = role;
        rows.back().run = run;
      });
  return rows;
}

double ScoreGoal::loss(double score) const {
  if (kind == Kind::nominal) return std::abs(score - nominal);
  return kind == Kind::higher ? -score : score;
}

std::string ScoreGoal::text() const {
  if (kind != Kind::nominal) return kind == Kind::higher ? "higher" : "lower";
  std::array<char, 32> digits{};
  return "nearest " + std::string(digits.data(), std::to_chars(digits.begin(), digits.end(), nominal).ptr);
}

std::optional<ScoreGoal> goal_of(const std::string& score, int states) {
  using Kind = ScoreGoal::Kind;
  std::string kind = score;
  for (const std::string role : {"_train_", "_test_"})
    if (const auto at = score.find(role); at != std::string::npos) kind = score.substr(at + role.size());
  if (kind == "log_score" || kind == "whiteness_p") return ScoreGoal{Kind::higher};
  if (kind.rfind("rmse", 0) == 0 || kind == "pit_distance") return ScoreGoal{Kind::lower};
  if (kind == "nis_mean") return ScoreGoal{Kind::nominal, static_cast<double>(states)};
  if (kind.rfind("too_", 0) == 0 || kind.rfind("nis_", 0) == 0) return ScoreGoal{Kind::nominal, true_tail};
  for (std::size_t b = 0; b < coverage_levels.size(); ++b)
    if (kind == "coverage_" + std::to_string(std::lround(100.0 * coverage_levels[b])))
      return ScoreGoal{Kind::nominal, coverage_levels[b]};
  return {};
}

const SummaryRow* pooled_row(const std::vector<SummaryRow>& summary, const std::string& filter, Role role) {
  for (const SummaryRow& row : summary)
    if (row.filter == filter && row.role == role && row.run == "*") return &row;
  return nullptr;
}

Role judged_role(const std::vector<SummaryRow>& summary) {
  return pooled_row(summary, "bank", Role::test) ? Role::test : Role::train;
}

}  // namespace modebank
