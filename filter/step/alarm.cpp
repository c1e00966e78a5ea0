#include "filter/step/alarm.hpp"

#include <cmath>

#include "ident/base/distributions.hpp"

namespace modebank {

LiveJudge::LiveJudge(const Bank& bank, double level, double alarm)
    : C_(bank.C),
      interval_quantile_(normal_quantile(0.5 + 0.5 * level)),
      alarm_tail_(0.5 * (1.0 - alarm)),
      verdict_{Eigen::VectorXd(C_.rows()), Eigen::VectorXd(C_.rows()), Eigen::VectorXd(C_.rows())} {}

const LiveVerdict& LiveJudge::judge(const FilterEstimate& estimate) {
  verdict_.predicted.noalias() = C_.lazyProduct(estimate.prediction);
  verdict_.alarm = false;
  for (Eigen::Index i = 0; i < C_.rows(); ++i) {
    const double half = interval_quantile_ * std::sqrt(estimate.innovation_covariance(i, i));
    verdict_.lower(i) = verdict_.predicted(i) - half;
    verdict_.upper(i) = verdict_.predicted(i) + half;
    const double pit = estimate.pit(i);
    if (pit < alarm_tail_ || pit > 1.0 - alarm_tail_) verdict_.alarm = true;  // NaN, a missing signal: never
  }
  return verdict_;
}

}  // namespace modebank
