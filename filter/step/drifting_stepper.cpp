#include "filter/step/drifting_stepper.hpp"

#include <cmath>

#include "filter/step/bank_filter.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

DriftingStepper::DriftingStepper(const Bank& bank)
    : recursion_(bank),
      noise_(bank.running_noise.nu),
      quantum_(bank.is_quantised() ? bank.quantum : Eigen::VectorXd::Zero(bank.structure.states)) {}

void DriftingStepper::skip(const Vector& v) {
  recursion_.predict(v);
  recursion_.skip();
}

double DriftingStepper::update(const Vector& y) {
  recursion_.update(y);
  double log_density = not_a_number;
  for (Index i = 0; i < quantum_.size(); ++i) {
    const double e = recursion_.innovation()(i), variance = recursion_.variance()(i);
    if (std::isnan(e)) continue;
    if (std::isnan(log_density)) log_density = 0.0;
    if (quantum_(i) > 0.0) {
      const double half = 0.5 * quantum_(i);
      log_density += noise_.log_mass((e - half) / deviation(i), (e + half) / deviation(i)) - std::log(quantum_(i));
    } else {
      log_density += noise_.log_density(e * e / variance) - 0.5 * std::log(variance);
    }
  }
  return log_density;
}

void DriftingStepper::combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) {
  const Index n = quantum_.size(), lagged = state.size() - n;
  state.head(n) = recursion_.prediction();
  state.tail(lagged) = recursion_.z().head(lagged);
  innovation_covariance.setZero();
  innovation_covariance.diagonal() = recursion_.variance();
}

void DriftingStepper::transform(const Vector&, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width) {
  for (Index i = 0; i < quantum_.size(); ++i) {
    const double e = recursion_.innovation()(i), half = 0.5 * quantum_(i);
    pit(i) = std::isnan(e) ? not_a_number : noise_.probability(e / deviation(i));
    if (std::isnan(e) || half == 0.0) continue;
    const double low = noise_.probability((e - half) / deviation(i)),
                 high = noise_.probability((e + half) / deviation(i));
    pit(i) = 0.5 * (low + high);
    width(i) = high - low;
  }
}

void DriftingStepper::merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) {
  mean = recursion_.z();
  covariance.setZero();
}

void DriftingStepper::save(FilterMemory& memory) const {
  const Index n = recursion_.z().size();
  memory.means = recursion_.z();
  memory.covariances.setZero(n * n, 1);
  memory.mode_probability = one_;
  memory.drift = recursion_.save();
}

void DriftingStepper::restore(const FilterMemory& memory) { recursion_.restore(memory.means.col(0), memory.drift); }

}  // namespace modebank
