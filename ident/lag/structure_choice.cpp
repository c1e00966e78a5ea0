#include "ident/lag/structure_choice.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/clustered_error.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr double least_gain_without_delay = 0.02;  // [nats/sample]
constexpr double negligible_loss = 1e-3;           // [nats/sample]

/// About a hundred structures are compared; the best one is expected to gain this much by chance [nats over all
/// samples].
constexpr double chance_gain = 6.0;

/// All structures by decreasing score; ties in the order of the map.
std::vector<Lags> by_score(const ScoredStructures& all) {
  std::vector<Lags> order;
  for (const auto& [lags, forecast] : all) order.push_back(lags);
  std::stable_sort(order.begin(), order.end(),
                   [&](const Lags& a, const Lags& b) { return all.at(a).log_score > all.at(b).log_score; });
  return order;
}

/// The structures that are as good as the best one, ordered by increasing size, then by decreasing score.
std::vector<Lags> as_good_by_size(const ScoredStructures& all, const StructureSize& size,
                                  const Eigen::VectorXd& weight) {
  std::vector<Lags> order = by_score(all);
  const LeftOutForecast& best = all.at(order.front());
  std::erase_if(order, [&](const Lags& lags) { return !loss_against(best, all.at(lags), weight).negligible(); });
  std::stable_sort(order.begin(), order.end(), [&](const Lags& a, const Lags& b) { return size(a) < size(b); });
  return order;
}

}  // namespace

ScoredStructures select(const ScoredStructures& all, bool (*wanted)(const Lags&)) {
  ScoredStructures selected;
  for (const auto& [lags, forecast] : all)
    if (wanted(lags)) selected.emplace(lags, forecast);
  return selected;
}

Lags best_of(const ScoredStructures& all) { return by_score(all).front(); }
Lags best_of(const ScoredStructures& all, bool (*wanted)(const Lags&)) { return best_of(select(all, wanted)); }

bool gains_enough(const ScoredStructures& at_once, const ScoredStructures& later, const Eigen::VectorXd& weight) {
  const StructureLoss gain = loss_against(at_once.at(best_of(at_once)), later.at(best_of(later)), weight);
  return gain.mean >= std::max(least_gain_without_delay, gain.standard_error);
}

Lags best_with_delay_rule(const ScoredStructures& all, const Eigen::VectorXd& weight) {
  const ScoredStructures at_once = select(all, &acts_at_once), later = select(all, &acts_later);
  if (later.empty() || (!at_once.empty() && gains_enough(at_once, later, weight))) return best_of(at_once);
  return best_of(later);
}

double loss_by_chance(double samples) { return std::max(negligible_loss, chance_gain / samples); }

bool StructureLoss::negligible() const { return !(mean > std::max(standard_error, loss_by_chance(weight))); }

StructureLoss loss_against(const LeftOutForecast& best, const LeftOutForecast& other, const Eigen::VectorXd& weight) {
  const Eigen::VectorXd lost = best.of_part - other.of_part;
  StructureLoss loss;
  loss.weight = weight.sum();
  loss.mean = lost.sum() / loss.weight;
  if (weight.size() > 1) loss.standard_error = clustered_error(lost, weight);
  return loss;
}

std::vector<Lags> finalists_of(const ScoredStructures& all, const StructureSize& size, const Eigen::VectorXd& weight,
                               std::size_t count) {
  std::vector<Lags> chosen;
  const auto add = [&](const std::vector<Lags>& from, std::size_t up_to) {
    for (const Lags& lags : from)
      if (chosen.size() < up_to && std::find(chosen.begin(), chosen.end(), lags) == chosen.end())
        chosen.push_back(lags);
  };
  if (all.empty()) return chosen;
  add(by_score(all), count / 2);
  add(as_good_by_size(all, size, weight), count);
  add(by_score(all), count);
  return chosen;
}

Lags smallest_as_good(const ScoredStructures& all, const StructureSize& size, const Eigen::VectorXd& weight) {
  return as_good_by_size(all, size, weight).front();
}

std::vector<StructureScore> score_table(const ScoredStructures& all, const Lags& chosen,
                                        const Eigen::VectorXd& weight) {
  std::vector<StructureScore> table;
  const std::vector<Lags> order = by_score(all);
  for (const Lags& lags : order) {
    const LeftOutForecast& forecast = all.at(lags);
    const StructureLoss loss = loss_against(all.at(order.front()), forecast, weight);
    table.push_back(
        {lags[0], lags[1], lags[2], forecast.log_score, loss.mean, loss.standard_error, forecast.rmse, lags == chosen});
  }
  return table;
}

}  // namespace modebank
