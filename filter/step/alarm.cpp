#include "filter/live_verdict.hpp"

#include <cmath>

#include "filter/calibration.hpp"

namespace modebank {

LiveJudge::LiveJudge(const Bank& bank, double level, double alarm)
    : C_(bank.C),
      interval_quantile_(normal_score(0.5 + 0.5 * level)),
      alarm_quantile_(normal_score(0.5 + 0.5 * alarm)),
      verdict_{Eigen::VectorXd(C_.rows()), Eigen::VectorXd(C_.rows()), Eigen::VectorXd(C_.rows())} {}

const LiveVerdict& LiveJudge::judge(const FilterEstimate& estimate) {
  verdict_.predicted.noalias() = C_.lazyProduct(estimate.prediction);
  verdict_.alarm = false;
  for (Eigen::Index i = 0; i < C_.rows(); ++i) {
    const double half = interval_quantile_ * std::sqrt(estimate.innovation_covariance(i, i));
    verdict_.lower(i) = verdict_.predicted(i) - half;
    verdict_.upper(i) = verdict_.predicted(i) + half;
    const double pit = estimate.pit(i);
    if (!std::isnan(pit) && std::abs(normal_score(pit)) > alarm_quantile_) verdict_.alarm = true;
  }
  return verdict_;
}

}  // namespace modebank
