#include "filter/judge/score/squared_distances.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

/// Mean distance per degree of freedom.
double mean_per_degree(const SquaredDistances& d) {
  return sample_count(d.value) > 0.0 ? sum_of(d.value) / sum_of(d.degrees) : not_a_number;
}

/// Deviation of each distance from its expected size, which is its degrees times the mean per degree. The mean of all
/// deviations is zero.
SeriesByRun deviations(const SquaredDistances& d) {
  const double share = mean_per_degree(d);
  SeriesByRun result = d.value;
  for (std::size_t r = 0; r < result.size(); ++r)
    for (std::size_t k = 0; k < result[r].size(); ++k) result[r][k] -= share * d.degrees[r][k];
  return result;
}

}  // namespace

void SquaredDistances::begin_run() {
  value.emplace_back();
  degrees.emplace_back();
}

void SquaredDistances::add(double distance, Eigen::Index d) {
  if (d == 0) return;
  value.back().push_back(distance);
  degrees.back().push_back(static_cast<double>(d));
}

Eigen::Index scored_signals(const RunEvaluation& evaluation, Eigen::Index sample) {
  return (!evaluation.pit.col(sample).array().isNaN()).count();
}

double mean_distance(const SquaredDistances& distances, double of_all) { return of_all * mean_per_degree(distances); }

Interval mean_distance_interval(const SquaredDistances& distances, double of_all, double level) {
  const double count = sample_count(distances.value);
  if (count == 0.0) return {not_a_number, not_a_number};
  const double time = cautious_time(autocorrelation_time(deviations(distances)), count);
  const double total = std::max(1.0, sum_of(distances.degrees) / time), outside = 0.5 * (1.0 - level);
  return {of_all * chi_square_quantile(outside, total) / total,
          of_all * chi_square_quantile(1.0 - outside, total) / total};
}

Eigen::VectorXd nis_of_all_signals(const RunEvaluation& e) {
  const Eigen::Index all = e.pit.rows();
  Eigen::VectorXd nis = e.nis;
  for (Eigen::Index k = 0; k < nis.size(); ++k) {
    const Eigen::Index there = scored_signals(e, k);
    if (there == 0 || there == all || std::isnan(nis(k))) continue;
    const double beyond = chi_square_upper_tail(nis(k), static_cast<double>(there));
    if (beyond > 0.0) nis(k) = chi_square_upper_quantile(beyond, static_cast<double>(all));
  }
  return nis;
}

Interval binomial_interval(double count, double samples, double level) {
  if (!(samples > 0.0)) return {not_a_number, not_a_number};
  const double misses = std::max(0.0, samples - count), beyond = 0.5 * (1.0 - level);
  return {count > 0.0 ? beta_quantile(beyond, count, misses + 1.0) : 0.0,
          misses > 0.0 ? beta_quantile(1.0 - beyond, count + 1.0, misses) : 1.0};
}

ScoreBands::ScoreBands()
    : near_square_(chi_square_quantile(true_tail, 1.0)), far_square_(chi_square_quantile(1.0 - true_tail, 1.0)) {
  for (std::size_t b = 0; b < edges_.size(); ++b) edges_[b] = normal_quantile(0.5 + 0.5 * coverage_levels[b]);
}

ScoreBands::Hits ScoreBands::of(double z) const {
  Hits hits{{}, z * z > far_square_, z * z < near_square_};
  for (std::size_t b = 0; b < edges_.size(); ++b) hits.outside[b] = std::abs(z) > edges_[b];
  return hits;
}

}  // namespace modebank
