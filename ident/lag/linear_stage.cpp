#include "ident/lag/linear_stage.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ident/base/interruption.hpp"
#include "ident/base/linalg.hpp"
#include "ident/lag/structure_choice.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index longest_delay = 30;

constexpr std::array<ArmaxOrder, 11> orders{{{false, 1, 1, 1},
                                             {false, 1, 2, 1},
                                             {false, 2, 2, 2},
                                             {false, 2, 3, 2},
                                             {true, 1, 1, 2},
                                             {true, 1, 2, 2},
                                             {true, 2, 2, 3},
                                             {true, 2, 3, 3},
                                             {false, 4, 4, 0},
                                             {false, 8, 8, 0},
                                             {false, 12, 8, 0}}};

/// Training runs. Missing values are zero, for no predicted sample has one among its lags.
ArmaxSamples gather(const Recording& recording, Index first) {
  constexpr Index before_first = 6;  // residuals that the first prediction of a stretch may use
  const double longest_s = 1.5 * recording.median_period_s();
  const Index N = recording.transitions(Role::train) + std::ssize(recording.runs);
  ArmaxSamples samples{.y = MatrixXd::Zero(recording.state_count(), N),
                       .u = MatrixXd::Zero(recording.input_count(), N)};
  std::vector<Index> run_of_row;
  Index at = 0, runs = 0;
  for (const Trajectory& run : recording.runs) {
    for (Index k = 0, lags = -1; k < run.samples() && run.role == Role::train; ++k, ++at) {
      const bool measured = run.states().col(k).allFinite() && run.inputs().col(k).allFinite();
      lags = !measured ? -1 : lags >= 0 && run.time_s(k) - run.time_s(k - 1) < longest_s ? lags + 1 : 0;
      if (!measured) continue;
      samples.y.col(at) = run.states().col(k);
      samples.u.col(at) = run.inputs().col(k);
      if (lags >= first - before_first) samples.long_rows.push_back(at);
      if (lags < first) continue;
      samples.rows.push_back(at);
      run_of_row.push_back(runs);
    }
    if (!run_of_row.empty() && run_of_row.back() == runs) ++runs;
  }
  samples.parts = stretch_parts(run_of_row, runs, 4, 5);
  return samples;
}

/// The first sample of a stretch has no difference, and no row uses it.
ArmaxSamples differences_of(ArmaxSamples samples) {
  samples.differences = true;
  for (MatrixXd* signal : {&samples.y, &samples.u})
    signal->rightCols(signal->cols() - 1) -= MatrixXd(signal->leftCols(signal->cols() - 1));
  return samples;
}

/// Subtracts the mean of a signal over the predicted samples.
VectorXd centre(MatrixXd& signal, const std::vector<Index>& rows) {
  const VectorXd mean = signal(Eigen::all, rows).rowwise().mean();
  signal.colwise() -= mean;
  return mean;
}

double half_deviance(const ArmaxSamples& samples, const MatrixXd& S) {
  return 0.5 * static_cast<double>(samples.count()) * log_determinant(S);
}

/// Delays, one input at a time: the latest within 2 nats by least squares, or by the likelihood of a fit's structure
/// among the fit's delay and the best three by least squares. The least, where an input hardly acts.
std::vector<Index> found_delays(const ArmaxSamples& samples, const std::vector<Index>& least, const ArmaxFit* fit) {
  constexpr int proposals = 4;
  constexpr double delay_nats = 2.0, acting_nats = 6.0;
  const ArmaxOrder start{samples.differences, 2, 2, 2 + samples.differences};
  ArmaxStructure tried{fit ? fit->order : start, fit ? fit->delays : least};
  for (std::size_t i = 0; i < least.size(); ++i) {
    Index& delay = tried.delays[i];
    const Index now = delay;
    VectorXd half = VectorXd::Constant(longest_delay + 1, HUGE_VAL), exact = half;
    for (delay = least[i]; delay <= longest_delay; ++delay)
      half(delay) = half_deviance(samples, least_squares_covariance(samples, tried));
    auto later = half.tail(longest_delay - least[i]);
    if (later.maxCoeff() < half.minCoeff() + acting_nats) later.setConstant(HUGE_VAL);
    if (fit) half(now) = -HUGE_VAL;
    for (int proposal = 0; fit && proposal < proposals && half.minCoeff(&delay) < HUGE_VAL; ++proposal) {
      half(delay) = HUGE_VAL;
      exact(delay) = half_deviance(samples, fit_armax(samples, tried, false).S);
    }
    const VectorXd& decides = fit ? exact : half;
    for (Index k = least[i]; k <= longest_delay; ++k)
      if (decides(k) < decides.minCoeff() + delay_nats) delay = k;
  }
  return tried.delays;
}

/// The constant for y and u that are not centred, and the covariance with it.
void uncentre(ArmaxFit& fit, const VectorXd& mean_y, const VectorXd& mean_u) {
  if (!fit.order.has_constant()) return;
  const Index n = fit.theta.rows(), last = fit.theta.cols() - 1, q = last + 1 + fit.C.cols();
  VectorXd mean(last);
  mean << mean_y.replicate(fit.order.state_lags, 1), mean_u.replicate(fit.order.input_lags, 1);
  fit.theta.col(last) += mean_y - fit.theta.leftCols(last) * mean;
  MatrixXd& V = fit.covariance;
  for (Index i = 0; i < n; ++i) V.row(i * q + last) -= mean.transpose() * V.middleRows(i * q, last);
  for (Index i = 0; i < n; ++i) V.col(i * q + last) -= V.middleCols(i * q, last) * mean;
}

/// Structures whose parameters the rows determine; without inputs, those that are then equal are one.
std::vector<ArmaxOrder> orders_of(const LinearStageOptions& options, const ArmaxSamples& samples) {
  std::vector<ArmaxOrder> result, asked(orders.begin(), orders.end());
  if (options.only) asked = {options.only->order};
  const Index n = samples.y.rows(), m = samples.u.rows();
  for (ArmaxOrder order : asked) {
    if (m == 0) order.input_lags = 0;
    if (!options.intercept) order.intercept = false;
    const Index columns = (order.state_lags + order.noise_lags) * n + order.input_lags * m + 1;
    if (4 * columns <= samples.count() && std::ranges::count(result, order) == 0) result.push_back(order);
  }
  return result;
}

using Forms = std::array<ArmaxSamples, 2>;  // levels and differences of the same samples

/// Fits all structures and chooses one.
void compare(LinearStage& stage, const Forms& forms, const std::array<std::vector<Index>, 2>& delays,
             const std::vector<ArmaxOrder>& structures) {
  std::vector<ArmaxFit>& all = stage.candidates;
  all.resize(structures.size());
  tbb::parallel_for(std::size_t{0}, structures.size(), [&](std::size_t i) {
    const std::size_t form = structures[i].differences ? 1 : 0;
    all[i] = fit_armax(forms[form], {structures[i], delays[form]}, true);
  });
  const auto score = [](const ArmaxFit& fit) { return fit.left_out.log_score; };
  stage.best = stage.chosen = static_cast<std::size_t>(std::ranges::max_element(all, {}, score) - all.begin());
  for (std::size_t i = 0; i < all.size(); ++i) {
    StructureLoss loss = loss_against(all[stage.best].left_out, all[i].left_out, stage.rows);
    loss.weight /= static_cast<double>(forms[0].y.rows());  // chance gains 6 nats per state
    const auto key = [&](const ArmaxFit& fit) { return std::pair(fit.size(), -score(fit)); };
    if (loss.negligible() && key(all[i]) < key(all[stage.chosen])) stage.chosen = i;
  }
}

}  // namespace

LinearStage find_linear_stage(const Recording& recording, const LinearStageOptions& options) {
  constexpr Index least_first = 40, least_rows = 120;
  std::vector<Index> least = options.least_delay;
  least.resize(static_cast<std::size_t>(recording.input_count()), 1);
  Index first = least_first;
  for (const Index delay : least) first = std::max(first, delay + longest_delay + 9);
  Forms forms{gather(recording, first), {}};
  ArmaxSamples& levels = forms[0];
  const std::vector<ArmaxOrder> structures = orders_of(options, levels);
  LinearStage stage{{}, 0, 0, part_rows_of(levels.parts), levels.parts.by_runs};
  if (levels.count() < least_rows || structures.empty()) return stage;
  forms[1] = differences_of(levels);
  if (!(forms[1].y(Eigen::all, levels.rows).cwiseAbs().rowwise().maxCoeff().minCoeff() > 0.0)) return stage;
  const bool centred = options.only ? options.only->order.intercept : options.intercept;
  const VectorXd mean_y = centred ? centre(levels.y, levels.rows) : VectorXd();
  const VectorXd mean_u = centred ? centre(levels.u, levels.rows) : VectorXd();
  std::array<std::vector<Index>, 2> delays;
  for (std::size_t form = 0; form < forms.size(); ++form) {
    add_residuals(forms[form], least);
    delays[form] = options.only ? options.only->delays : found_delays(forms[form], least, nullptr);
  }
  compare(stage, forms, delays, structures);
  if (!options.only) {
    interruption_point();
    const ArmaxFit& fit = stage.fit();
    delays.fill(found_delays(forms[fit.order.differences ? 1 : 0], least, &fit));
    if (delays[0] != fit.delays) compare(stage, forms, delays, structures);
  }
  for (ArmaxFit& fit : stage.candidates) uncentre(fit, mean_y, mean_u);
  return stage;
}

}  // namespace modebank
