#include "filter/step/combined_filter.hpp"

#include <numeric>
#include <utility>

#include "filter/step/equations/arithmetic.hpp"

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

CombinedFilter::CombinedFilter(std::vector<BankFilter> filters, const std::vector<double>& start)
    : filters_(std::move(filters)),
      combines_(true),
      weights_(start, 1),
      log_densities_(filters_.size()),
      estimate_(filters_.front().estimate()),
      combined_(estimate_.innovation.size()),
      apart_(estimate_.innovation) {
  take_first();
}

CombinedFilter::CombinedFilter(BankFilter alone) : combines_(false), weights_(1), combined_(0) {
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

/// Combines the filters with their weights before this sample, but those that have not started or have failed.
void CombinedFilter::mix(const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  FilterEstimate& mixed = estimate_;
  const Index n = mixed.innovation.size();
  mixed.log_density = filter::ForecastWeights::mixed_log_density(weights_.weights(), log_densities_);
  double spoken = 0.0;
  const auto each = [&](auto add) {
    for (std::size_t i = 0; i < filters_.size(); ++i)
      if (const FilterEstimate& said = filters_[i].estimate(); said.prediction.allFinite())
        add(weights_.weights()[i], said);
  };
  each([&](double weight, const FilterEstimate&) { spoken += weight; });
  if (!(spoken > 0.0)) return;
  for (auto* vector : {&mixed.prediction, &mixed.state, &mixed.pit, &mixed.pit_width}) vector->setZero();
  for (auto* matrix : {&mixed.innovation_covariance, &mixed.covariance}) matrix->setZero();
  each([&](double weight, const FilterEstimate& said) {
    mixed.prediction += weight / spoken * said.prediction.head(n);
    mixed.state += weight / spoken * said.state.head(n);
    mixed.pit += weight / spoken * said.pit;
    mixed.pit_width += weight / spoken * said.pit_width;
  });
  each([&](double weight, const FilterEstimate& said) {
    apart_ = said.prediction.head(n) - mixed.prediction;
    small::add_about_mean(mixed.innovation_covariance, weight / spoken, said.innovation_covariance, apart_);
    apart_ = said.state.head(n) - mixed.state;
    small::add_about_mean(mixed.covariance, weight / spoken, said.covariance.topLeftCorner(n, n), apart_);
  });
  combined_.innovation = measurement - mixed.prediction;
  combined_.normalise(mixed.innovation_covariance, measurement);
  mixed.innovation = combined_.innovation;
  mixed.nis = combined_.nis;
}

std::vector<StateForecast> CombinedFilter::forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                                    Index steps) const {
  std::vector<StateForecast> mixed = filters_.front().forecast(inputs, steps);
  if (!combines_) return mixed;
  std::vector<std::vector<StateForecast>> said;
  std::vector<double> weights;
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    if (!filters_[i].started()) continue;
    said.push_back(filters_[i].forecast(inputs, steps));
    weights.push_back(weights_.weights()[i]);
  }
  const double spoken = std::accumulate(weights.begin(), weights.end(), 0.0);
  const Index n = estimate_.state.size();
  const double value = said.empty() ? not_a_number : 0.0;
  for (std::size_t k = 0; k < mixed.size(); ++k) {
    Eigen::VectorXd& state = mixed[k].state.setConstant(n, value);
    mixed[k].covariance.setConstant(n, n, value);
    for (std::size_t i = 0; i < said.size(); ++i) state += weights[i] / spoken * said[i][k].state.head(n);
    for (std::size_t i = 0; i < said.size(); ++i)
      small::add_about_mean(mixed[k].covariance, weights[i] / spoken, said[i][k].covariance.topLeftCorner(n, n),
                            said[i][k].state.head(n) - state);
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
