#include "filter/judge/scores.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "ident/base/distributions.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// A number of samples as a divisor; NaN for none.
double divisor(Index samples) { return samples > 0 ? static_cast<double>(samples) : not_a_number; }

/// A sample is scored by its available signals.
SummaryRow summary_of(SummaryRow row, const std::vector<std::size_t>& runs,
                      const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores) {
  const Index n_y = evaluations.at(runs.front()).innovation.rows();
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(n_y), errors = squares;
  std::vector<Interval> region{{0.0, 0.0}};  // of the NIS of 0 to n_y signals
  for (double d = 1.0; d <= static_cast<double>(n_y); ++d)
    region.push_back({chi_square_quantile(true_tail, d), chi_square_quantile(1.0 - true_tail, d)});
  ScoredSignals signals;
  std::vector<double> pit, whiteness;
  for (const std::size_t i : runs) {
    const RunEvaluation& run = evaluations.at(i);
    signals.begin_run(run);
    whiteness.push_back(scores.at(i).whiteness_p);
    for (Index k = 0; k < run.log_density.size(); ++k) {
      if (std::isnan(run.log_density(k))) continue;
      ++row.samples;
      row.log_score += run.log_density(k);
      signals.add(run, scores[i], k);
      const auto there = (!run.pit.col(k).array().isNaN()).eval();
      squares += there.select(run.innovation.col(k).array().square(), 0.0);
      errors += there.cast<double>();
      row.nis_below += run.nis(k) < region[there.count()].lower ? 1.0 : 0.0;
      row.nis_above += there.any() && run.nis(k) > region[there.count()].upper ? 1.0 : 0.0;
      for (const double value : run.pit.col(k))
        if (!std::isnan(value)) pit.push_back(value);
    }
  }
  const double N = divisor(row.samples);
  row.log_score /= N;
  row.rmse = (squares / errors).sqrt();
  row.nis_mean = signals.nis.mean(static_cast<double>(n_y));
  row.nis_above /= N;
  row.nis_below /= N;
  const auto inside = [&](double level) { return 1.0 - mean_of(outside_band(signals.z, level)); };
  row.too_far = mean_of(outside_band(signals.z, 1.0 - true_tail));
  row.too_close = inside(true_tail);
  row.coverage_50 = inside(0.50);
  row.coverage_90 = inside(0.90);
  row.coverage_95 = inside(0.95);
  row.coverage_99 = inside(0.99);
  row.pit_distance = kolmogorov_distance(pit);
  row.whiteness_p = fisher_p(whiteness);
  return row;
}

FreeRunRow free_run_row(FreeRunRow row, const std::vector<std::size_t>& runs, const std::vector<Trajectory>& all,
                        const std::vector<FreeRun>& predicted) {
  const Index n_y = all[runs.front()].state.rows();
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(n_y), sum = squares, square_sum = squares, origin;
  Eigen::ArrayXXd inside = Eigen::ArrayXXd::Zero(n_y, std::ssize(coverage_levels));
  for (const std::size_t i : runs) {
    row.lost_paths += predicted.at(i).lost_paths;
    for (Index k = 0; k < all[i].samples(); ++k) {
      if (std::isnan(predicted[i].log_density(k))) continue;
      const Eigen::ArrayXd y = all[i].state.col(k);
      if (row.samples++ == 0) origin = y;  // subtracted from all: so large measurements lose fewer digits
      row.log_score += predicted[i].log_density(k);
      squares += (y - predicted[i].mean.col(k).array()).square();
      sum += y - origin;
      square_sum += (y - origin).square();
      for (Index b = 0; b < inside.cols(); ++b)
        inside.col(b) += ((predicted[i].pit.col(k).array() - 0.5).abs() <= 0.5 * coverage_levels[b]).cast<double>();
    }
  }
  const double N = divisor(row.samples);
  row.log_score /= N;
  row.rmse = (squares / N).sqrt();
  const Eigen::ArrayXd variance = (square_sum / N - (sum / N).square()).max(0.0);
  row.nrmse = (variance > 0.0).select(row.rmse.array() / variance.sqrt(), not_a_number);
  row.fit = 100.0 * (1.0 - row.nrmse.array());
  row.coverage_50 = inside.col(0) / N;
  row.coverage_90 = inside.col(1) / N;
  row.coverage_95 = inside.col(2) / N;
  row.coverage_99 = inside.col(3) / N;
  return row;
}

}  // namespace

std::vector<SummaryRow> summarize(const std::string& filter, Role role, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores) {
  std::vector<SummaryRow> rows;
  for (const RunGroup& group : run_groups(runs, role))
    rows.push_back(summary_of({filter, role, group.name}, group.runs, evaluations, scores));
  return rows;
}

std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run) {
  std::vector<HorizonSums> sums;
  for (std::size_t h = 0; h < run.horizons.size(); ++h) {
    const Eigen::MatrixXd& error = run.error[h];
    HorizonSums& sum = sums.emplace_back(HorizonSums{run.horizons[h], 0, 0.0, Eigen::ArrayXd::Zero(error.rows())});
    for (Index k = 0; k < error.cols(); ++k) {
      const double value = run.log_density(h, k);
      if (std::isnan(value)) continue;
      ++sum.samples;
      sum.log_density += value;
      sum.squared_error += error.col(k).array().square();
      sum.inside += static_cast<double>(((run.pit[h].col(k).array() - 0.5).abs() <= 0.475).count());
    }
  }
  return sums;
}

void pool(const std::vector<HorizonSums>& run, std::vector<HorizonSums>& all) {
  if (all.empty())
    for (const HorizonSums& of : run) all.push_back({of.horizon, 0, 0.0, 0.0 * of.squared_error});
  for (std::size_t h = 0; h < all.size(); ++h) {
    all[h].samples += run.at(h).samples;
    all[h].log_density += run[h].log_density;
    all[h].squared_error += run[h].squared_error;
    all[h].inside += run[h].inside;
  }
}

std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums) {
  std::vector<HorizonRow> rows;
  for (const Role role : {Role::train, Role::test})
    for (const RunGroup& group : run_groups(runs, role)) {
      std::vector<HorizonSums> all;
      for (const std::size_t i : group.runs) pool(sums.at(i), all);
      for (const HorizonSums& of : all) {
        const double N = divisor(of.samples), inside = of.inside / (N * static_cast<double>(of.squared_error.size()));
        rows.push_back({filter, role, group.name, of.horizon, of.samples, of.log_density / N,
                        (of.squared_error / N).sqrt(), inside});
      }
    }
  return rows;
}

std::vector<FreeRunRow> summarize_free_runs(const std::string& filter, const std::vector<Trajectory>& runs,
                                            const std::vector<FreeRun>& free_runs, const FreeRunOptions& options) {
  std::vector<FreeRunRow> rows;
  for (const Role role : {Role::train, Role::test})
    for (const RunGroup& group : run_groups(runs, role))
      rows.push_back(free_run_row({filter, role, group.name, options.samples}, group.runs, runs, free_runs));
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
  for (const double level : coverage_levels)
    if (kind == "coverage_" + std::to_string(std::lround(100.0 * level))) return ScoreGoal{Kind::nominal, level};
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
