#include "filter/step/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "ident/base/distributions.hpp"
#include "ident/base/seed.hpp"

namespace modebank {

std::uint64_t pit_seed(std::uint64_t seed, std::string_view run) {
  return derive_seed(seed, "pit of " + std::string(run));
}

void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit) {
  std::mt19937_64 generator = make_generator(of_run, "pit", static_cast<std::uint64_t>(sample));
  for (Eigen::Index i = 0; i < pit.size(); ++i) {
    const double draw = std::ldexp(static_cast<double>(generator() >> 11U), -53);
    if (width(i) > 0.0) pit(i) = std::clamp(pit(i) + (draw - 0.5) * width(i), 0.0, 1.0);
  }
}

LiveJudge::LiveJudge(const Bank& bank)
    : C_(bank.C),
      interval_quantile_(normal_quantile(0.975)),  // normal quantile for 95 % intervals
      verdict_{Eigen::VectorXd(C_.rows()), Eigen::VectorXd(C_.rows()), Eigen::VectorXd(C_.rows())} {}

const LiveVerdict& LiveJudge::judge(const FilterEstimate& estimate) {
  verdict_.predicted.noalias() = C_.lazyProduct(estimate.prediction);
  verdict_.alarm = false;
  constexpr double alarm_tail = 0.0005;  // tail probability on each side; a correct model has one such sample in 1000
  for (Eigen::Index i = 0; i < C_.rows(); ++i) {
    const double half = interval_quantile_ * std::sqrt(estimate.innovation_covariance(i, i));
    verdict_.lower(i) = verdict_.predicted(i) - half;
    verdict_.upper(i) = verdict_.predicted(i) + half;
    const double pit = estimate.pit(i);
    if (pit < alarm_tail || pit > 1.0 - alarm_tail) verdict_.alarm = true;  // false for NaN (a missing signal)
  }
  return verdict_;
}

}  // namespace modebank
