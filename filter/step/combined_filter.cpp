#include "filter/step/combined_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "filter/step/gaussian.hpp"
#include "ident/base/not_a_number.hpp"
#include "modebank/base/eigen.hpp"

namespace modebank::filter {

namespace {

constexpr double kept_per_sample = 0.99;     // forgetting factor of Raftery, Karny & Ettler
constexpr double least_log_weight = -700.0;  // for a density of zero, so that a forecaster can recover

/// The largest number; NaN if there is none.
double largest(const std::vector<double>& values) {
  double most = not_a_number;
  for (const double value : values) most = std::fmax(most, value);
  return most;
}

void require_one_each(const std::vector<double>& weights, const std::vector<double>& log_densities) {
  if (weights.size() != log_densities.size())
    throw std::invalid_argument(std::to_string(log_densities.size()) + " log densities of " +
                                std::to_string(weights.size()) + " forecasters");
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
  if (largest(start_) <= least_log_weight) throw std::invalid_argument("the starting weights have no positive value");
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
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    evidence_[i] = std::max(evidence_[i] - most, least_log_weight);
    weights_[i] = start_[i] + evidence_[i];
  }
  Eigen::Map<Eigen::ArrayXd> weights(weights_.data(), std::ssize(weights_));
  weights = (weights - std::max(weights.maxCoeff(), least_log_weight)).max(least_log_weight).exp();
  weights /= weights.sum();
}

/// Expectation-maximisation. A forecaster without a value for a sample keeps its weight.
std::vector<double> ForecastWeights::stacked(const std::vector<std::vector<double>>& log_densities) {
  constexpr int most_steps = 500;
  constexpr double least_weight = 1e-3, close = 1e-6;
  const Eigen::Index count = std::ssize(log_densities), samples = count > 0 ? std::ssize(log_densities.front()) : 0;
  Eigen::ArrayXXd density = Eigen::ArrayXXd::Zero(samples, count), silent = density;  // of samples with finite values
  for (Eigen::Index k = 0; k < samples; ++k) {
    double most = not_a_number;
    for (const std::vector<double>& of_one : log_densities) most = std::fmax(most, of_one.at(k));
    for (Eigen::Index i = 0; i < count && std::isfinite(most); ++i) {
      const double said = log_densities[i][k];
      silent(k, i) = std::isnan(said) ? 1.0 : 0.0;
      density(k, i) = std::isnan(said) ? 0.0 : std::exp(said - most);
    }
  }
  Eigen::ArrayXd weights = Eigen::ArrayXd::Constant(count, 1.0 / static_cast<double>(count));
  double change = count > 1 ? 1.0 : 0.0;
  for (int step = 0; step < most_steps && change > close; ++step) {
    const Eigen::ArrayXd mixed = density.matrix() * weights.matrix(),
                         spoken = 1.0 - (silent.matrix() * weights.matrix()).array();
    const Eigen::ArrayXd ratio = (mixed > 0.0).select(spoken / mixed, 0.0);
    Eigen::ArrayXd next = weights * (density.colwise() * ratio + silent).colwise().sum().transpose();
    if (!(next.sum() > 0.0)) break;
    next /= next.sum();
    change = (next - weights).abs().maxCoeff();
    weights = next;
  }
  if (count > 1) weights = weights.max(least_weight);
  return to_vector(weights / weights.sum());
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
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (std::isnan(log_densities[i])) continue;
    spoken += weights[i];
    sum += weights[i] * std::exp(log_densities[i] - most);
  }
  return most + std::log(sum / spoken);
}

}  // namespace modebank::filter

namespace modebank {

using Eigen::Index;

Bank combined_frame(const Bank& bank) {
  const Index n = bank.C.rows();
  Bank frame = bank;
  frame.structure = {n, bank.structure.inputs, bank.structure.intercept};
  frame.state_names.resize(n);
  frame.input_names.resize(bank.structure.inputs);
  frame.C = Eigen::MatrixXd::Identity(n, n);
  frame.drift = {};
  frame.transition_logit = {};
  const Index p = frame.structure.parameters();
  for (Mode& mode : frame.modes)
    mode = {unpack(frame.structure, Eigen::VectorXd(Eigen::VectorXd::Zero(p))), mode.Q.topLeftCorner(n, n).eval(),
            Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), mode.weight};
  return frame;
}

namespace {

/// Mean and covariance of the mixture of the filters' estimates. They have the sizes that `mixed` has.
void merge(const std::vector<double>& shares, const std::vector<BankFilter>& filters,
           Eigen::VectorXd FilterEstimate::*mean, Eigen::MatrixXd FilterEstimate::*covariance, FilterEstimate& mixed) {
  const Index n = (mixed.*mean).size();
  (mixed.*mean).setZero();
  (mixed.*covariance).setZero();
  const auto mean_of = [&](std::size_t i) { return (filters[i].estimate().*mean).head(n); };
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0.0) mixed.*mean += shares[i] * mean_of(i);
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0.0)
      small::add_about_mean(mixed.*covariance, shares[i], filters[i].estimate().*covariance, mean_of(i) - mixed.*mean);
}

}  // namespace

CombinedFilter::CombinedFilter(std::vector<BankFilter> filters, const std::vector<double>& start)
    : filters_(std::move(filters)),
      combines_(true),
      weights_(start, 1),
      log_densities_(filters_.size()),
      shares_(filters_.size()),
      estimate_(filters_.front().estimate()),
      innovation_(estimate_.innovation.size()) {
  const Index n = estimate_.innovation.size();
  estimate_.prediction.conservativeResize(n);
  estimate_.state.conservativeResize(n);
  estimate_.covariance.conservativeResize(n, n);
}

CombinedFilter::CombinedFilter(BankFilter alone) : combines_(false), weights_(1), innovation_(0) {
  filters_.push_back(std::move(alone));
}

const FilterEstimate& CombinedFilter::step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                                           const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  if (!combines_) return filters_.front().step(time_s, input, measurement);
  for (std::size_t i = 0; i < filters_.size(); ++i)
    log_densities_[i] = filters_[i].step(time_s, input, measurement).log_density;
  take_measured(filters_.front().estimate(), estimate_);  // as it is where this filter starts
  if (estimate_.steps == 0)
    weights_.restart();
  else
    mix(measurement);
  weights_.observe(log_densities_);
  return estimate_;
}

/// Combines the filters with their weights before this sample.
void CombinedFilter::mix(const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  FilterEstimate& mixed = estimate_;
  const auto said = [&](std::size_t i) -> const FilterEstimate& { return filters_[i].estimate(); };
  mixed.log_density = filter::ForecastWeights::mixed_log_density(weights_.weights(), log_densities_);
  double spoken = 0.0;  // weight of the filters that have started and did not fail
  for (std::size_t i = 0; i < shares_.size(); ++i)
    spoken += shares_[i] = said(i).prediction.allFinite() ? weights_.weights()[i] : 0.0;
  for (double& share : shares_) share /= spoken;
  for (Eigen::VectorXd FilterEstimate::*transform : {&FilterEstimate::pit, &FilterEstimate::pit_width}) {
    (mixed.*transform).setZero();
    for (std::size_t i = 0; i < shares_.size(); ++i)
      if (shares_[i] != 0.0) mixed.*transform += shares_[i] * (said(i).*transform);
  }
  merge(shares_, filters_, &FilterEstimate::state, &FilterEstimate::covariance, mixed);
  merge(shares_, filters_, &FilterEstimate::prediction, &FilterEstimate::innovation_covariance, mixed);
  innovation_.observe(mixed.prediction, measurement, mixed);
}

CombinedFilter::Snapshot CombinedFilter::snapshot() const {
  Snapshot snapshot{{}, weights_};
  for (const BankFilter& filter : filters_) snapshot.filters.push_back(filter.snapshot());
  return snapshot;
}

void CombinedFilter::restore(const Snapshot& snapshot) {
  for (std::size_t i = 0; i < filters_.size(); ++i) filters_[i].restore(snapshot.filters[i]);
  weights_ = snapshot.weights;
}

void CombinedFilter::restart() {
  for (BankFilter& filter : filters_) filter.restart();
  weights_.restart();
}

}  // namespace modebank
