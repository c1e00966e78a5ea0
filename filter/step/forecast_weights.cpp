#include "modebank/filter/forecast_weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace modebank::filter {

namespace {

constexpr double kept_per_sample = 0.99;     // Raftery, Karny & Ettler's
constexpr double least_log_weight = -700.0;  // of a density of zero, which must be able to come back

/// The largest that is a number; NaN without any.
double largest(const std::vector<double>& values) {
  double most = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) most = std::fmax(most, value);
  return most;
}

}  // namespace

ForecastWeights::ForecastWeights(std::size_t forecasters, std::ptrdiff_t horizon)
    : ForecastWeights(std::vector<double>(forecasters, 1.0), horizon) {}

ForecastWeights::ForecastWeights(const std::vector<double>& start, std::ptrdiff_t horizon)
    : share_of_a_sample_(1.0 / static_cast<double>(horizon)), weights_(start.size()) {
  if (start.empty() || horizon < 1)
    throw std::invalid_argument("weights need a forecaster, and a horizon of at least one sample");
  for (const double weight : start) {
    if (!(weight >= 0.0) || std::isinf(weight)) throw std::invalid_argument("a weight to start with is negative");
    start_.push_back(std::max(std::log(weight), least_log_weight));
  }
  if (*std::max_element(start_.begin(), start_.end()) <= least_log_weight)
    throw std::invalid_argument("no weight to start with is positive");
  restart();
}

void ForecastWeights::restart() {
  log_weights_ = start_;
  normalise();
}

void ForecastWeights::observe(const std::vector<double>& log_densities) {
  if (log_densities.size() != log_weights_.size())
    throw std::invalid_argument(std::to_string(log_densities.size()) + " log densities of " +
                                std::to_string(log_weights_.size()) + " forecasters");
  // The silent are taken to have said what all say together, so that the others' scores do not move them.
  const double together = mixed_log_density(weights_, log_densities);
  if (std::isnan(together)) return;
  for (std::size_t i = 0; i < log_weights_.size(); ++i) {
    const double said = std::isnan(log_densities[i]) ? together : log_densities[i];
    log_weights_[i] = kept_per_sample * log_weights_[i] + share_of_a_sample_ * std::max(said, least_log_weight);
  }
  normalise();
}

void ForecastWeights::normalise() {
  const double most = largest(log_weights_);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    log_weights_[i] = std::max(log_weights_[i] - most, least_log_weight);
    sum += weights_[i] = std::exp(log_weights_[i]);
  }
  for (double& weight : weights_) weight /= sum;
}

std::vector<double> ForecastWeights::spoken_weights(const std::vector<double>& weights,
                                                    const std::vector<double>& log_densities) {
  if (weights.size() != log_densities.size())
    throw std::invalid_argument(std::to_string(log_densities.size()) + " log densities of " +
                                std::to_string(weights.size()) + " forecasters");
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
  const std::vector<double> spoken = spoken_weights(weights, log_densities);
  const double most = largest(log_densities);
  if (!std::isfinite(most)) return most;
  double sum = 0.0;
  for (std::size_t i = 0; i < spoken.size(); ++i)
    if (spoken[i] > 0.0) sum += spoken[i] * std::exp(log_densities[i] - most);
  return most + std::log(sum);
}

}  // namespace modebank::filter
