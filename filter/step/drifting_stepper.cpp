#include "filter/step/drifting_stepper.hpp"

#include <cmath>

#include "filter/step/bank_filter.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

DriftingStepper::DriftingStepper(const Bank& bank) : recursion_(bank), weight_(bank.running_noise.levels()) {}

void DriftingStepper::skip(const Vector& v) {
  recursion_.predict(v);
  recursion_.skip();
}

void DriftingStepper::combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) {
  const Index n = recursion_.prediction().size(), lagged = state.size() - n;
  state.head(n) = recursion_.prediction();
  state.tail(lagged) = recursion_.z().head(lagged);
  innovation_covariance.setZero();
  innovation_covariance.diagonal() = recursion_.variance();
}

void DriftingStepper::transform(const Vector&, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width,
                                double&) {
  for (Index i = 0; i < pit.size(); ++i) {
    const double half = 0.5 * recursion_.quantum()(i);
    pit(i) = not_a_number;
    if (std::isnan(recursion_.innovation()(i))) continue;
    recursion_.weigh_levels(i, weight_);
    pit(i) = recursion_.probability(i, 0.0, weight_);
    if (std::isnan(pit(i))) pit(i) = 1.0;  // outside all bands if the prediction failed
    if (half == 0.0) continue;
    const double low = recursion_.probability(i, -half, weight_), high = recursion_.probability(i, half, weight_);
    if (std::isnan(high - low)) continue;
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
