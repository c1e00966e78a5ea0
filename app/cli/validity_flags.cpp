#include "app/cli/validity_flags.hpp"

#include <algorithm>

namespace modebank::app {
namespace {

/// Number of predictions before a filter has settled. Mean log scores of predictions 1 to 5, 6 to 10 and 11 to 30 of a
/// run:
/// - DRIVE (201 runs): 1.27, 1.41, 1.46
/// - ICE (24): 2.34, 2.76, 3.15
/// - FLOORING (16): 2.19, 2.39, 2.66
constexpr Eigen::Index unsettled_samples = 10;

/// Tail probability on either side, under the mixture of all modes. The flag is not set if even one mode with
/// probability 0.001 predicts the measurement. On held-out runs the flag is set for 0 of 5,533 samples of ICE, 1 of
/// 10,300 of DRIVE, 3 of 7,138 of FLOORING.
constexpr double unlike_tail = 1e-6;

}  // namespace

ValidityFlags ValidityJudge::judge(double time_s, const Eigen::VectorXd& input, const FilterEstimate& estimate,
                                   bool started) {
  ValidityFlags flags;
  if (samples_ > 0) {
    const Eigen::Index steps = SampleFeed::steps_between(last_s_, time_s, dt_s_);
    flags.stamp_late = steps > 1;
    if (steps > longest_gap_steps) restart();
  }
  last_s_ = time_s;
  ++samples_;
  flags.warming_up = !started || samples_ <= lags_ + unsettled_samples;
  flags.input_beyond_training = is_beyond_training(input);
  for (const double pit : estimate.pit)
    if (pit < unlike_tail || pit > 1.0 - unlike_tail)
      flags.unlike_any_mode = true;  // comparisons with NaN (a missing signal)
                                     // are false
  return flags;
}

/// A missing input is a repeated value, which was judged when it arrived.
bool ValidityJudge::is_beyond_training(const Eigen::VectorXd& input) const {
  for (Eigen::Index i = 0; i < std::min(input.size(), trained_.least.size()); ++i)
    if (input(i) < trained_.least(i) || input(i) > trained_.largest(i)) return true;
  return false;
}

}  // namespace modebank::app
