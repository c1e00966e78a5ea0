#include "filter/judge/statistics.hpp"

#include <algorithm>
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>
#include <limits>

#include "ident/base/distributions.hpp"
#include "ident/base/lagged_product.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

namespace {

double sum_of(const SeriesByRun& series) {
  double sum = 0.0;
  for (const auto& x : series)
    for (const double value : x) sum += value;
  return sum;
}

/// The runs of a series, relative to the mean of all runs.
std::vector<Eigen::ArrayXd> centred(const SeriesByRun& series) {
  const double mean = mean_of(series);
  std::vector<Eigen::ArrayXd> runs;
  for (const std::vector<double>& x : series)
    runs.emplace_back(Eigen::Map<const Eigen::ArrayXd>(x.data(), std::ssize(x)) - mean);
  return runs;
}

/// Sum of the products of values `lag` samples apart within one run.
double autocovariance(const std::vector<Eigen::ArrayXd>& runs, Index lag) {
  double sum = 0.0;
  for (const Eigen::ArrayXd& run : runs) sum += lagged_product(run, run, lag);
  return sum;
}

/// Autocorrelations at lags 1, 2, ... as long as the sums of pairs, of lags 0 and 1 first, are positive.
std::vector<double> autocorrelations(const SeriesByRun& series) {
  const std::vector<Eigen::ArrayXd> runs = centred(series);
  const double variance = autocovariance(runs, 0);
  Index longest = 0;
  for (const Eigen::ArrayXd& run : runs) longest = std::max(longest, run.size());
  std::vector<double> result;
  for (Index lag = 0; lag + 1 < longest && variance > 0.0; lag += 2) {
    const double even = lag == 0 ? variance : autocovariance(runs, lag), odd = autocovariance(runs, lag + 1);
    if (even + odd <= 0.0) break;
    if (lag > 0) result.push_back(even / variance);
    result.push_back(odd / variance);
  }
  return result;
}

double time_of(const std::vector<double>& correlations) {
  double time = 1.0;
  for (const double r : correlations) time += 2.0 * r;
  return std::max(1.0, time);
}

/// Replaces every value by the normal quantile of its rank among all.
SeriesByRun normal_ranks(SeriesByRun series) {
  std::vector<double*> order;
  for (auto& x : series)
    for (double& value : x) order.push_back(&value);
  std::stable_sort(order.begin(), order.end(), [](const double* a, const double* b) { return *a < *b; });
  const auto count = static_cast<double>(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) *order[i] = normal_score((static_cast<double>(i) + 0.5) / count);
  return series;
}

/// Correlation of the indicators that two standard normal variables of correlation r exceed their quantile q of the
/// upper `true_tail`. The probability that both do is true_tail - 2 T(q, sqrt((1 - r) / (1 + r))) with T of Owen (1956,
/// Annals of Mathematical Statistics 27).
double tail_correlation(double r) {
  constexpr double near_one = 0.999;  // estimates of larger correlations are rounding errors of 1
  r = std::clamp(r, -near_one, near_one);
  const double both =
      true_tail - 2.0 * boost::math::owens_t(normal_quantile(1.0 - true_tail), std::sqrt((1.0 - r) / (1.0 + r)));
  return (both - true_tail * true_tail) / (true_tail * (1.0 - true_tail));
}

Index scored_signals(const RunEvaluation& evaluation, Index sample) {
  return (!evaluation.pit.col(sample).array().isNaN()).count();
}

}  // namespace

Eigen::MatrixXd normal_scores(const Eigen::MatrixXd& pit) {
  return pit.unaryExpr([](double value) { return std::isnan(value) ? not_a_number : normal_score(value); });
}

RunScores score_run(const RunEvaluation& e) {
  RunScores scores{normal_scores(e.pit), Eigen::VectorXi::Zero(e.log_density.size())};
  SeriesByRun z(e.pit.rows());
  for (Index k = 0; k < e.log_density.size(); ++k) {
    if (std::isnan(e.log_density(k))) continue;
    if (e.mode_probability_predicted.rows() > 1) e.mode_probability_predicted.col(k).maxCoeff(&scores.likeliest(k));
    for (std::size_t i = 0; i < z.size(); ++i)
      if (const double score = scores.z(i, k); !std::isnan(score)) z[i].push_back(score);
  }
  scores.whiteness_p = whiteness_p(z);
  return scores;
}

ResidualTests test_innovations(const Trajectory& run, const RunScores& scores, const ResidualTestOptions& options) {
  // Sample k + 1 is the end of transition k, whose input is u[k].
  return test_residuals(scores.z.rightCols(run.transitions()), run.input.leftCols(run.transitions()), options);
}

std::vector<RunGroup> run_groups(const std::vector<Trajectory>& runs, Role role) {
  std::vector<RunGroup> groups;
  RunGroup all{"*", {}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].role != role) continue;
    groups.push_back({runs[i].run, {i}});
    all.runs.push_back(i);
  }
  if (!groups.empty()) groups.push_back(all);
  return groups;
}

double whiteness_p(const SeriesByRun& z) {
  std::vector<double> p_values;
  for (const std::vector<double>& output : z) p_values.push_back(ljung_box_p(output));
  return fisher_p(p_values);
}

double kolmogorov_distance(std::vector<double> values) {
  if (values.empty()) return not_a_number;
  std::sort(values.begin(), values.end());
  const double count = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double below = static_cast<double>(i) / count, above = static_cast<double>(i + 1) / count;
    distance = std::max({distance, above - values[i], values[i] - below});
  }
  return distance;
}

double ljung_box_p(const std::vector<double>& series) {
  const std::vector<Eigen::ArrayXd> run = centred({series});
  const Index N = std::ssize(series), lags = std::min(most_tested_lags, N / 5);
  const double variance = autocovariance(run, 0);
  if (lags < 1 || !(variance > 0.0)) return not_a_number;
  Eigen::VectorXd autocorrelation(lags + 1);
  for (Index k = 0; k <= lags; ++k) autocorrelation(k) = autocovariance(run, k) / variance;
  return ljung_box_p(autocorrelation, N);
}

double fisher_p(const std::vector<double>& p_values) {
  double statistic = 0.0, degrees_of_freedom = 0.0;
  for (const double p : p_values) {
    if (std::isnan(p)) continue;
    statistic -= 2.0 * std::log(std::max(p, std::numeric_limits<double>::min()));
    degrees_of_freedom += 2.0;
  }
  return degrees_of_freedom > 0.0 ? chi_square_upper_tail(statistic, degrees_of_freedom) : not_a_number;
}

double sample_count(const SeriesByRun& series) {
  double count = 0.0;
  for (const auto& x : series) count += static_cast<double>(x.size());
  return count;
}

double mean_of(const SeriesByRun& series) {
  const double count = sample_count(series);
  return count > 0.0 ? sum_of(series) / count : not_a_number;
}

Autocorrelation largest_autocorrelation(const SeriesByRun& series, Index most) {
  const std::vector<Eigen::ArrayXd> runs = centred(series);
  Autocorrelation largest;
  const double variance = autocovariance(runs, 0);
  const auto lags = std::min(most, static_cast<Index>(sample_count(series)) / 5);
  for (Index lag = 1; lag <= lags && variance > 0.0; ++lag)
    if (const double value = autocovariance(runs, lag) / variance; std::abs(value) > std::abs(largest.value))
      largest = {lag, value};
  return largest;
}

double autocorrelation_time(const SeriesByRun& series) {
  return sample_count(series) > 0.0 ? time_of(autocorrelations(series)) : not_a_number;
}

double autocorrelation_time_of_tail(const SeriesByRun& series) {
  if (sample_count(series) == 0.0) return not_a_number;
  std::vector<double> correlations = autocorrelations(normal_ranks(series));
  for (double& r : correlations) r = tail_correlation(r);
  return time_of(correlations);
}

double cautious_time(double time, double samples) {
  return 1.0 + (time - 1.0) * (1.0 + std::sqrt((8.0 * time + 2.0) / samples));
}

double SquaredDistances::mean(double of_all) const {
  return sample_count(value) > 0.0 ? of_all * (sum_of(value) / sum_of(degrees)) : not_a_number;
}

Interval SquaredDistances::mean_interval(double of_all, double level) const {
  const double count = sample_count(value), share = mean(1.0);
  if (count == 0.0) return {not_a_number, not_a_number};
  SeriesByRun away = value;  // from the expected size, which is the degrees times the mean per degree
  for (std::size_t r = 0; r < away.size(); ++r)
    for (std::size_t k = 0; k < away[r].size(); ++k) away[r][k] -= share * degrees[r][k];
  const double time = cautious_time(autocorrelation_time(away), count);
  const double total = std::max(1.0, sum_of(degrees) / time), outside = 0.5 * (1.0 - level);
  return {of_all * chi_square_quantile(outside, total) / total,
          of_all * chi_square_quantile(1.0 - outside, total) / total};
}

Eigen::VectorXd nis_of_all_signals(const RunEvaluation& e) {
  const Index all = e.pit.rows();
  Eigen::VectorXd nis = e.nis;
  for (Index k = 0; k < nis.size(); ++k) {
    const Index there = scored_signals(e, k);
    if (there == 0 || there == all || std::isnan(nis(k))) continue;
    const double beyond = chi_square_upper_tail(nis(k), static_cast<double>(there));
    if (beyond > 0.0) nis(k) = chi_square_upper_quantile(beyond, static_cast<double>(all));
  }
  return nis;
}

void ScoredSignals::begin_run(const RunEvaluation& run) {
  z.emplace_back().reserve(run.pit.size());
  nis.value.emplace_back().reserve(run.pit.cols());
  nis.degrees.emplace_back().reserve(run.pit.cols());
}

void ScoredSignals::add(const RunEvaluation& run, const RunScores& scores, Index k) {
  for (const double value : scores.z.col(k))
    if (!std::isnan(value)) z.back().push_back(value);
  const Index signals = scored_signals(run, k);
  if (signals == 0) return;
  nis.value.back().push_back(run.nis(k));
  nis.degrees.back().push_back(static_cast<double>(signals));
}

SeriesByRun outside_band(SeriesByRun z, double level) {
  const double edge = normal_quantile(0.5 + 0.5 * level);
  for (std::vector<double>& run : z)
    for (double& value : run) value = std::abs(value) > edge ? 1.0 : 0.0;
  return z;
}

Interval binomial_interval(double count, double samples, double level) {
  if (!(samples > 0.0)) return {not_a_number, not_a_number};
  const double misses = std::max(0.0, samples - count), beyond = 0.5 * (1.0 - level);
  return {count > 0.0 ? beta_quantile(beyond, count, misses + 1.0) : 0.0,
          misses > 0.0 ? beta_quantile(1.0 - beyond, count + 1.0, misses) : 1.0};
}

}  // namespace modebank
