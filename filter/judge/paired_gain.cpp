#include "filter/judge/paired_gain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>

#include "filter/judge/statistics.hpp"
#include "ident/base/clustered_error.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr std::size_t fewest_runs = 5;
constexpr double fewest_blocks = 8.0;
constexpr double times_per_block = 2.0;
constexpr double upper_probability = 0.975;

/// Differences at the samples that both filters have scored, run by run. Runs without such samples are skipped.
SeriesByRun differences(const std::vector<Eigen::VectorXd>& better, const std::vector<Eigen::VectorXd>& other) {
  SeriesByRun result;
  for (std::size_t r = 0; r < better.size(); ++r) {
    if (better[r].size() != other.at(r).size())
      throw std::invalid_argument("log densities of one run have different lengths");
    std::vector<double> run;
    for (Index k = 0; k < better[r].size(); ++k)
      if (const double d = better[r](k) - other[r](k); !std::isnan(d)) run.push_back(d);
    if (!run.empty()) result.push_back(std::move(run));
  }
  return result;
}

double stretch_sum(const std::vector<double>& values, std::size_t first, std::size_t count) {
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
  return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(count), 0.0);
}

/// Means of adjacent stretches of `length` samples; 0 means whole runs.
std::vector<double> means(const SeriesByRun& d, std::size_t length) {
  std::vector<double> result;
  for (const std::vector<double>& run : d) {
    const std::size_t count = length > 0 ? length : run.size();
    for (std::size_t first = 0; first + count <= run.size(); first += count)
      result.push_back(stretch_sum(run, first, count) / static_cast<double>(count));
  }
  return result;
}

struct MeanError {
  double standard_error = not_a_number, degrees_of_freedom = 0.0;
};

MeanError error_by_runs(const SeriesByRun& d) {
  Eigen::VectorXd sums(std::ssize(d)), samples(std::ssize(d));
  for (Index r = 0; r < sums.size(); ++r) {
    const std::vector<double>& run = d[static_cast<std::size_t>(r)];
    sums(r) = stretch_sum(run, 0, run.size());
    samples(r) = static_cast<double>(run.size());
  }
  return {clustered_error(sums, samples), static_cast<double>(sums.size()) - 1.0};
}

std::size_t block_length(const SeriesByRun& d) {
  const double time = cautious_time(autocorrelation_time(d), sample_count(d));
  return static_cast<std::size_t>(std::ceil(times_per_block * time));
}

MeanError error_by_blocks(const SeriesByRun& d, double mean, std::size_t length) {
  const double samples = sample_count(d);
  double side_by_side = 0.0, squares = 0.0, count = 0.0;
  for (const auto& run : d) {
    const std::size_t whole_blocks = run.size() / length;
    side_by_side += static_cast<double>(whole_blocks);
    for (std::size_t first = 0; first + length <= run.size(); ++first) {
      const double excess = stretch_sum(run, first, length) - mean * static_cast<double>(length);
      squares += excess * excess;
      ++count;
    }
  }
  if (side_by_side < fewest_blocks) return {};
  const double B = side_by_side, b = static_cast<double>(length);
  return {std::sqrt(B / (B - 1.0) * squares / count / (b * samples)), B - 1.0};
}

/// P(sum of randomly chosen ranks >= sum), over all choices.
double exact_tail(const std::vector<std::size_t>& ranks, std::size_t sum) {
  std::vector<double> ways(std::accumulate(ranks.begin(), ranks.end(), std::size_t{1}), 0.0);
  ways[0] = 1.0;
  for (const std::size_t rank : ranks)
    for (std::size_t s = ways.size(); s-- > 0;) ways[s] = 0.5 * (ways[s] + (s >= rank ? ways[s - rank] : 0.0));
  return std::accumulate(ways.begin() + static_cast<std::ptrdiff_t>(sum), ways.end(), 0.0);
}

double normal_tail(const std::vector<std::size_t>& ranks, std::size_t sum) {
  double total = 0.0, squares = 0.0;
  for (const std::size_t rank : ranks) {
    total += static_cast<double>(rank);
    squares += static_cast<double>(rank * rank);
  }
  return 0.5 * std::erfc((static_cast<double>(sum) - 0.5 * total) / std::sqrt(0.5 * squares));
}

}  // namespace

PairedGain paired_gain(const std::string& competitor, const std::vector<Eigen::VectorXd>& better,
                       const std::vector<Eigen::VectorXd>& other) {
  const SeriesByRun d = differences(better, other);
  PairedGain result{competitor, static_cast<Index>(sample_count(d)), mean_of(d)};
  result.by_blocks = d.size() < fewest_runs;
  result.standard_error = result.margin = not_a_number;
  if (!std::isfinite(result.gain)) return result;
  const std::size_t length = result.by_blocks ? block_length(d) : 0;
  const MeanError error = result.by_blocks ? error_by_blocks(d, result.gain, length) : error_by_runs(d);
  result.standard_error = error.standard_error;
  result.degrees_of_freedom = error.degrees_of_freedom;
  result.rank_p = signed_rank_p(means(d, length));
  if (error.degrees_of_freedom > 0.0)
    result.margin = student_quantile(upper_probability, error.degrees_of_freedom) * error.standard_error;
  return result;
}

double signed_rank_p(const std::vector<double>& differences) {
  constexpr std::size_t most_exact = 50;
  std::vector<double> sorted;
  std::copy_if(differences.begin(), differences.end(), std::back_inserter(sorted), [](double d) { return d != 0.0; });
  if (sorted.empty()) return 1.0;
  std::sort(sorted.begin(), sorted.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  // Ranks are doubled: so they are whole numbers even if equal sizes share ranks.
  std::vector<std::size_t> ranks;
  std::size_t sum = 0;
  for (std::size_t first = 0, next = 0; first < sorted.size(); first = next) {
    while (next < sorted.size() && std::abs(sorted[next]) == std::abs(sorted[first])) ++next;
    ranks.resize(next, first + 1 + next);
    for (std::size_t i = first; i < next; ++i) sum += sorted[i] > 0.0 ? ranks[i] : 0;
  }
  return sorted.size() <= most_exact ? exact_tail(ranks, sum) : normal_tail(ranks, sum);
}

}  // namespace modebank
