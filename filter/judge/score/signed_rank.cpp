#include "filter/judge/score/signed_rank.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace modebank {
namespace {

/// Twice the ranks of increasing sizes. Doubled ranks are whole numbers even if equal sizes share ranks.
std::vector<std::size_t> double_ranks(const std::vector<double>& sizes) {
  std::vector<std::size_t> ranks(sizes.size());
  for (std::size_t first = 0, next = 0; first < sizes.size(); first = next) {
    while (next < sizes.size() && sizes[next] == sizes[first]) ++next;
    std::fill(ranks.begin() + static_cast<std::ptrdiff_t>(first), ranks.begin() + static_cast<std::ptrdiff_t>(next),
              first + 1 + next);
  }
  return ranks;
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

double signed_rank_p(const std::vector<double>& differences) {
  constexpr std::size_t most_exact = 50;
  std::vector<double> sorted;
  std::copy_if(differences.begin(), differences.end(), std::back_inserter(sorted), [](double d) { return d != 0.0; });
  std::sort(sorted.begin(), sorted.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  std::vector<double> sizes(sorted.size());
  std::transform(sorted.begin(), sorted.end(), sizes.begin(), [](double d) { return std::abs(d); });
  const std::vector<std::size_t> ranks = double_ranks(sizes);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) sum += sorted[i] > 0.0 ? ranks[i] : 0;
  if (sorted.empty()) return 1.0;
  return sorted.size() <= most_exact ? exact_tail(ranks, sum) : normal_tail(ranks, sum);
}

}  // namespace modebank
