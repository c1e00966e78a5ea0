#include "modebank/filter/forecast_weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace modebank::filter {

namespace {

constexpr double kept_per_sample = 0.99;     // forgetting factor of Raftery, Karny & Ettler
constexpr double least_log_weight = -700.0;  // replaces the log density if the density is zero, so that a forecaster
                                             // can recover

/// The largest number; NaN if the list is empty.
double largest(const std::vector<double>& values) {
  double most = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) most = std::fmax(most, value);
  return most;
}

void require_one_each(const std::vector<double>& weights, const std::vector<double>& log_densities) {
  if (weights.size() != log_densities.size())
    throw std::invalid_argument(std::to_string(log_densities.size()) + " log densities of " +
                                std::to_string(weights.size()) + " forecasters");
}

/// Densities of all forecasters for each sample, divided by the sample's largest density; NaN without a value.
std::vector<double> relative_densities(const std::vector<std::vector<double>>& log_densities) {
  const std::size_t forecasters = log_densities.size();
  std::vector<double> densities, one(forecasters);
  for (std::size_t k = 0; k < log_densities.front().size(); ++k) {
    for (std::size_t i = 0; i < forecasters; ++i) one[i] = log_densities[i].at(k);
    const double most = largest(one);
    if (!std::isfinite(most)) continue;
    for (const double value : one) densities.push_back(std::exp(value - most));
  }
  return densities;
}

/// One iteration of expectation-maximisation. A forecaster without a value for a sample keeps its weight.
std::vector<double> likelier_weights(const std::vector<double>& weights, const std::vector<double>& densities) {
  const std::size_t forecasters = weights.size();
  std::vector<double> next(forecasters, 0.0);
  for (std::size_t first = 0; first < densities.size(); first += forecasters) {
    double mixed = 0.0, spoken = 0.0;
    for (std::size_t i = 0; i < forecasters; ++i) {
      if (std::isnan(densities[first + i])) continue;
      mixed += weights[i] * densities[first + i];
      spoken += weights[i];
    }
    for (std::size_t i = 0; i < forecasters; ++i) {
      const double density = densities[first + i];
      next[i] += std::isnan(density) || !(mixed > 0.0) ? weights[i] : weights[i] * density * spoken / mixed;
    }
  }
  const double samples = std::accumulate(next.begin(), next.end(), 0.0);
  if (!(samples > 0.0)) return weights;
  for (double& weight : next) weight /= samples;
  return next;
}

}  // namespace

ForecastWeights::ForecastWeights(std::size_t forecasters, std::ptrdiff_t horizon)
    : ForecastWeights(std::vector<double>(forecasters, 1.0), horizon) {}

ForecastWeights::ForecastWeights(const std::vector<double>& start, std::ptrdiff_t horizon)
    : share_of_a_sample_(1.0 / static_cast<double>(horizon)), weights_(start.size()) {
  if (start.empty() || horizon < 1)
    throw std::invalid_argument("weights need at least one forecaster and a horizon of at least one sample");
  for (const double weight : start) {
    if (!(weight >= 0.0) || std::isinf(weight))
      throw std::invalid_argument("a starting weight is negative or not finite");
    start_.push_back(std::max(std::log(weight), least_log_weight));
  }
  if (*std::max_element(start_.begin(), start_.end()) <= least_log_weight)
    throw std::invalid_argument("the starting weights have no positive value");
  restart();
}

void ForecastWeights::restart() {
  evidence_.assign(start_.size(), 0.0);
  normalise();
}

void ForecastWeights::observe(const std::vector<double>& log_densities) {
  // A forecaster without a value gets the density of the mixture. Its weight then does not depend on the scores of the
  // other forecasters.
  const double together = mixed_log_density(weights_, log_densities);
  if (std::isnan(together)) return;
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    const double said = std::isnan(log_densities[i]) ? together : log_densities[i];
    evidence_[i] = kept_per_sample * evidence_[i] + share_of_a_sample_ * std::max(said, least_log_weight);
  }
  normalise();
}

void ForecastWeights::normalise() {
  const double most = largest(evidence_);
  double highest = least_log_weight;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    evidence_[i] = std::max(evidence_[i] - most, least_log_weight);
    weights_[i] = start_[i] + evidence_[i];
    highest = std::max(highest, weights_[i]);
  }
  double sum = 0.0;
  for (double& weight : weights_) sum += weight = std::exp(std::max(weight - highest, least_log_weight));
  for (double& weight : weights_) weight /= sum;
}

std::vector<double> ForecastWeights::stacked(const std::vector<std::vector<double>>& log_densities) {
  constexpr int most_steps = 500;
  constexpr double least_weight = 1e-3, close = 1e-6;
  std::vector<double> weights(log_densities.size(), 1.0 / static_cast<double>(log_densities.size()));
  if (weights.size() < 2) return weights;
  const std::vector<double> densities = relative_densities(log_densities);
  double change = densities.empty() ? 0.0 : 1.0;
  for (int step = 0; step < most_steps && change > close; ++step) {
    const std::vector<double> next = likelier_weights(weights, densities);
    change = 0.0;
    for (std::size_t i = 0; i < next.size(); ++i) change = std::max(change, std::abs(next[i] - weights[i]));
    weights = next;
  }
  double sum = 0.0;
  for (double& weight : weights) sum += weight = std::max(weight, least_weight);
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::vector<double> ForecastWeights::spoken_weights(const std::vector<double>& weights,
                                                    const std::vector<double>& log_densities) {
  require_one_each(weights, log_densities);
  std::vector<double> spoken(weights.size(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isnan(log_densities[i])) sum += spoken[i] = weights[i];
  if (sum > 0.0)
    for (double& weight : spoken) weight /= sum;
  return spoken;
}

double ForecastWeights::mixed_log_density(const std::vector<double>& weights,
                                          const std::vector<double>& log_densities) {
  require_one_each(weights, log_densities);
  const double most = largest(log_densities);
  if (!std::isfinite(most)) return most;
  double spoken = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isnan(log_densities[i])) spoken += weights[i];
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isnan(log_densities[i]) && weights[i] > 0.0)
      sum += weights[i] / spoken * std::exp(log_densities[i] - most);
  return most + std::log(sum);
}

}  // namespace modebank::filter
