#include "filter/judge/scores.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "filter/judge/statistics.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Sums over scored samples of one or more runs. A sample is scored by its available signals.
class ScoreSums {
 public:
  explicit ScoreSums(Index measurements)
      : squared_error_(Eigen::ArrayXd::Zero(measurements)), errors_(Eigen::ArrayXd::Zero(measurements)) {
    for (Index i = 1; i <= measurements; ++i)
      nis_tails_.push_back({chi_square_quantile(true_tail, static_cast<double>(i)),
                            chi_square_quantile(1.0 - true_tail, static_cast<double>(i))});
  }

  void add(const RunEvaluation& run, const RunScores& scores) {
    nis_.begin_run();
    for (Index k = 0; k < run.log_density.size(); ++k)
      if (!std::isnan(run.log_density(k))) add_sample(run, k, scores);
    whiteness_.push_back(scores.whiteness_p);
  }

  SummaryRow row() const {
    SummaryRow row;
    row.samples = samples_;
    const double N = samples_ > 0 ? static_cast<double>(samples_) : not_a_number;
    const double components = pit_.empty() ? not_a_number : static_cast<double>(pit_.size());
    row.log_score = log_density_ / N;
    row.rmse = (squared_error_ / errors_).sqrt();
    row.nis_mean = mean_distance(nis_, static_cast<double>(errors_.size()));
    row.nis_above = static_cast<double>(nis_above_) / N;
    row.nis_below = static_cast<double>(nis_below_) / N;
    row.too_far = static_cast<double>(too_far_) / components;
    row.too_close = static_cast<double>(too_close_) / components;
    row.coverage_50 = static_cast<double>(inside_[0]) / components;
    row.coverage_90 = static_cast<double>(inside_[1]) / components;
    row.coverage_95 = static_cast<double>(inside_[2]) / components;
    row.coverage_99 = static_cast<double>(inside_[3]) / components;
    row.pit_distance = kolmogorov_distance(pit_);
    row.whiteness_p = fisher_p(whiteness_);
    return row;
  }

 private:
  Index samples_ = 0, nis_above_ = 0, nis_below_ = 0, too_far_ = 0, too_close_ = 0;
  double log_density_ = 0.0;
  SquaredDistances nis_;
  Eigen::ArrayXd squared_error_, errors_;
  std::vector<double> pit_, whiteness_;
  std::vector<Interval> nis_tails_;                     ///< limits of the tails for one signal, two signals, ...
  std::array<Index, coverage_levels.size()> inside_{};  ///< number of signals inside each central band
  ScoreBands bands_;

  void add_sample(const RunEvaluation& run, Index k, const RunScores& scores) {
    ++samples_;
    log_density_ += run.log_density(k);
    const auto there = (!run.pit.col(k).array().isNaN()).eval();
    squared_error_ += there.select(run.innovation.col(k).array().square(), 0.0);
    errors_ += there.cast<double>();
    const Index signals = scored_signals(run, k);
    nis_.add(run.nis(k), signals);
    if (signals > 0) {
      const Interval& tails = nis_tails_[static_cast<std::size_t>(signals - 1)];
      nis_above_ += run.nis(k) > tails.upper;
      nis_below_ += run.nis(k) < tails.lower;
    }
    for (Index i = 0; i < run.pit.rows(); ++i) {
      if (!there(i)) continue;
      const ScoreBands::Hits hits = bands_.of(scores.z(i, k));
      too_far_ += hits.far;
      too_close_ += hits.close;
      for (std::size_t b = 0; b < inside_.size(); ++b) inside_[b] += !hits.outside[b];
      pit_.push_back(run.pit(i, k));
    }
  }
};

}  // namespace

std::vector<SummaryRow> summarize(const std::string& filter, Role role, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores) {
  if (runs.size() != evaluations.size() || runs.size() != scores.size())
    throw std::invalid_argument(std::to_string(runs.size()) + " runs, but " + std::to_string(evaluations.size()) +
                                " evaluations and " + std::to_string(scores.size()) + " of them scored");
  std::vector<SummaryRow> rows;
  const auto add_row = [&](const ScoreSums& sums, const std::string& run) {
    rows.push_back(sums.row());
    rows.back().filter = filter;
    rows.back().role = role;
    rows.back().run = run;
  };
  std::optional<ScoreSums> pooled;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].role != role) continue;
    ScoreSums single(evaluations[i].innovation.rows());
    single.add(evaluations[i], scores[i]);
    add_row(single, runs[i].run);
    if (!pooled) pooled.emplace(evaluations[i].innovation.rows());
    pooled->add(evaluations[i], scores[i]);
  }
  if (pooled) add_row(*pooled, "*");
  return rows;
}

double ScoreGoal::loss(double score) const {
  switch (kind) {
    case Kind::higher:
      return -score;
    case Kind::lower:
      return score;
    case Kind::nominal:
      return std::abs(score - nominal);
  }
  return not_a_number;
}

std::string ScoreGoal::text() const {
  switch (kind) {
    case Kind::higher:
      return "higher";
    case Kind::lower:
      return "lower";
    case Kind::nominal:
      break;
  }
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
