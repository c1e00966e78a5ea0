#include "filter/step/combined_filter.hpp"

#include <utility>

#include "filter/step/gaussian.hpp"

namespace modebank {

using Eigen::Index;

Bank combined_frame(const Bank& bank) {
  const Index n = bank.C.rows();
  Bank frame = bank;
  frame.structure = {n, bank.structure.inputs, bank.structure.intercept};
  frame.state_names.resize(static_cast<std::size_t>(n));
  frame.input_names.resize(static_cast<std::size_t>(bank.structure.inputs));
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

/// The weights of the filters that speak, with sum one. The others have not started, or failed.
template <class Speaks>
void share_out(const std::vector<double>& weights, Speaks speaks, std::vector<double>& shares) {
  double spoken = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) spoken += shares[i] = speaks(i) ? weights[i] : 0.0;
  for (double& share : shares) share /= spoken;
}

/// Mean and covariance of the mixture of part(0), part(1), ..., each a mean and a covariance.
template <class Part>
void merge(const std::vector<double>& shares, Part part, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
  mean.setZero(part(0).first.size());
  covariance.setZero(mean.size(), mean.size());
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0.0) mean += shares[i] * part(i).first;
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0.0) small::add_about_mean(covariance, shares[i], part(i).second, part(i).first - mean);
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
  take_first();
}

CombinedFilter::CombinedFilter(BankFilter alone) : combines_(false), weights_(1), innovation_(0) {
  filters_.push_back(std::move(alone));
}

const FilterEstimate& CombinedFilter::step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                                           const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  if (!combines_) return filters_.front().step(time_s, input, measurement);
  for (std::size_t i = 0; i < filters_.size(); ++i)
    log_densities_[i] = filters_[i].step(time_s, input, measurement).log_density;
  take_first();
  if (estimate_.steps == 0)
    weights_.restart();
  else
    mix(measurement);
  weights_.observe(log_densities_);
  return estimate_;
}

/// The first filter's estimate with the measured states alone. It is used as it is where that filter starts.
void CombinedFilter::take_first() {
  const FilterEstimate& said = filters_.front().estimate();
  const Index n = said.innovation.size();
  estimate_.prediction = said.prediction.head(n);
  estimate_.innovation = said.innovation;
  estimate_.innovation_covariance = said.innovation_covariance;
  estimate_.state = said.state.head(n);
  estimate_.covariance = said.covariance.topLeftCorner(n, n);
  estimate_.pit = said.pit;
  estimate_.pit_width = said.pit_width;
  estimate_.mode_probability_predicted = said.mode_probability_predicted;
  estimate_.mode_probability = said.mode_probability;
  estimate_.nis = said.nis;
  estimate_.log_density = said.log_density;
  estimate_.steps = said.steps;
}

/// Combines the filters with their weights before this sample.
void CombinedFilter::mix(const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  FilterEstimate& mixed = estimate_;
  const Index n = mixed.innovation.size();
  const auto said = [&](std::size_t i) -> const FilterEstimate& { return filters_[i].estimate(); };
  mixed.log_density = filter::ForecastWeights::mixed_log_density(weights_.weights(), log_densities_);
  share_out(
      weights_.weights(), [&](std::size_t i) { return said(i).prediction.allFinite(); }, shares_);
  for (Eigen::VectorXd FilterEstimate::*transform : {&FilterEstimate::pit, &FilterEstimate::pit_width}) {
    (mixed.*transform).setZero();
    for (std::size_t i = 0; i < shares_.size(); ++i)
      if (shares_[i] != 0.0) mixed.*transform += shares_[i] * (said(i).*transform);
  }
  merge(
      shares_, [&](std::size_t i) { return std::pair(said(i).state.head(n), said(i).covariance.topLeftCorner(n, n)); },
      mixed.state, mixed.covariance);
  merge(
      shares_,
      [&](std::size_t i) {
        return std::pair(said(i).prediction.head(n), said(i).innovation_covariance.topLeftCorner(n, n));
      },
      mixed.prediction, mixed.innovation_covariance);
  innovation_.observe(mixed.prediction, measurement, mixed);
}

std::vector<StateForecast> CombinedFilter::forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                                    Index steps) const {
  std::vector<StateForecast> mixed = filters_.front().forecast(inputs, steps);
  if (!combines_) return mixed;
  std::vector<std::vector<StateForecast>> said;
  for (const BankFilter& filter : filters_) said.push_back(filter.forecast(inputs, steps));
  const Index n = estimate_.state.size();
  std::vector<double> shares(filters_.size());
  for (std::size_t k = 0; k < mixed.size(); ++k) {
    share_out(
        weights_.weights(), [&](std::size_t i) { return said[i][k].state.allFinite(); }, shares);
    merge(
        shares,
        [&](std::size_t i) { return std::pair(said[i][k].state.head(n), said[i][k].covariance.topLeftCorner(n, n)); },
        mixed[k].state, mixed[k].covariance);
  }
  return mixed;
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
