#include "ident/model/step_response.hpp"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

#include "ident/base/covariance.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/sample_quantile.hpp"
#include "ident/base/seed.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unit_circle = 1.0 - 1e-12;  // a pole beyond it does not settle; the slack allows for rounding
constexpr double band = 0.05;                // share of the steady value within which a state counts as settled
constexpr double tail = 0.16;                // share of the draws beyond each end of a range
constexpr Index draws = 200, most_steps = 4000, fine_steps = 500, coarser_after = 250;
const double reached = std::exp(-1.0);

constexpr MatrixXd StepResponse::*numbers[] = {&StepResponse::response_s, &StepResponse::settling_s,
                                               &StepResponse::gain, &StepResponse::overshoot, &StepResponse::radius};

/// Follows the distance to the steady value, as a share of it, from `before` at `time` to `now` a stride later.
void note_crossings(StepResponse& found, Index i, Index j, double time_s, double stride_s, double before, double now) {
  const auto crossing = [&](double level) { return time_s + stride_s * (before - level) / (before - now); };
  if (std::isnan(found.response_s(i, j)) && now <= reached) found.response_s(i, j) = std::max(0.0, crossing(reached));
  if (std::abs(before) > band && std::abs(now) <= band)
    found.settling_s(i, j) = std::max(0.0, crossing(std::copysign(band, before)));
  if (std::abs(now) > band) found.settling_s(i, j) = not_a_number;
  found.overshoot(i, j) = std::max(found.overshoot(i, j), -now);
}

/// Simulates the distance from the steady state, e[k] = M e[k-1] - (the part of B that does not act yet), for all
/// inputs at once. After the first steps the stride doubles now and then, so that slow models end, too.
void simulate(StepResponse& found, const LinearStructure& s, const LinearModel& model, const std::vector<Index>& delay,
              double dt_s) {
  MatrixXd M = model.full_form(), distance = -found.gain.replicate(s.state_lags, 1);
  MatrixXd next(distance.rows(), distance.cols());
  const double order = static_cast<double>(s.dimension()), start = order + static_cast<double>(s.input_lags);
  const double longest = start + (12.0 + 2.0 * order) / -std::log(found.radius(0));
  double samples = 0.0, stride = 1.0;
  for (Index k = 0; k < most_steps && samples < longest; ++k, samples += stride) {
    if (k >= std::max(fine_steps, s.input_lags) && k % coarser_after == 0) M *= MatrixXd(M), stride *= 2.0;
    next.noalias() = M * distance;
    for (Index lag = k + 1; lag < s.input_lags; ++lag) next -= model.B.middleCols(lag * s.inputs, s.inputs);
    for (Index j = 0; j < s.inputs; ++j) {
      const double time_s = (samples + static_cast<double>(delay[static_cast<std::size_t>(j)] - 1)) * dt_s;
      for (Index i = 0; i < s.states; ++i)
        if (const double gain = found.gain(i, j); gain != 0.0)
          note_crossings(found, i, j, time_s, stride * dt_s, -distance(i, j) / gain, -next(i, j) / gain);
    }
    distance.swap(next);
  }
}

/// Half the range of a number over the draws; infinite if its upper end lies among draws that have no such number.
double half_range(const std::vector<StepResponse>& drawn, MatrixXd StepResponse::*number, Index e) {
  std::vector<double> values;
  for (const StepResponse& one : drawn)
    if (const double value = (one.*number)(e); !std::isnan(value)) values.push_back(value);
  if (static_cast<double>(values.size()) < (1.0 - tail) * draws) return INFINITY;
  std::ranges::sort(values);
  return (sample_quantile(values, 1.0 - tail) - sample_quantile(values, tail)) / 2.0;
}

StepResponse response(const LinearStructure& s, const VectorXd& theta, const std::vector<Index>& delay, double dt_s) {
  StepResponse found;
  for (const auto number : numbers) (found.*number).setConstant(s.states, s.inputs, not_a_number);
  const LinearModel model = unpack(s, theta);
  found.radius.fill(spectral_radius(model));
  if (!(found.radius(0) < unit_circle)) return found;
  MatrixXd held = MatrixXd::Zero(s.dimension(), s.inputs);
  for (Index first = 0; first < s.acting_inputs(); first += s.inputs) held += model.B.middleCols(first, s.inputs);
  found.gain = PivotedLu(-model.A).solve(held).topRows(s.states);
  for (Index e = 0; e < found.gain.size(); ++e) found.overshoot(e) = found.gain(e) != 0.0 ? 0.0 : not_a_number;
  simulate(found, s, model, delay, dt_s);
  return found;
}

}  // namespace

EstimatedStepResponse step_response(const LinearStructure& s, const VectorXd& theta, const MatrixXd& covariance,
                                    const std::vector<Index>& delay, double dt_s) {
  EstimatedStepResponse result{
      response(s, theta, delay, dt_s), {}, MatrixXd::Constant(s.states, s.inputs, not_a_number)};
  for (const auto number : numbers) (result.error.*number).setConstant(s.states, s.inputs, not_a_number);
  if (covariance.rows() != theta.size() || !covariance.allFinite()) return result;
  auto generator = make_generator(0, "step response");
  boost::random::normal_distribution<double> normal(0.0, 1.0);
  std::vector<StepResponse> drawn(draws);
  const MatrixXd root = covariance_root(covariance);
  for (StepResponse& one : drawn) {
    const VectorXd z = VectorXd::NullaryExpr(root.cols(), [&](Index) { return normal(generator); });
    one = response(s, theta + root * z, delay, dt_s);
  }
  result.never_settles.setZero();
  for (const StepResponse& one : drawn) result.never_settles.array() += one.radius(0) < unit_circle ? 0.0 : 1.0 / draws;
  for (const auto number : numbers)
    for (Index e = 0; e < s.states * s.inputs; ++e) (result.error.*number)(e) = half_range(drawn, number, e);
  return result;
}

}  // namespace modebank
