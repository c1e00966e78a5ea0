#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ident/base/clustered_error.hpp"
#include "ident/base/interruption.hpp"
#include "ident/base/linalg.hpp"
#include "ident/lag/armax_fit.hpp"
#include "ident/lag/student_density.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Delays = std::vector<Index>;

constexpr Index longest_delay = 30, least_first = 39, least_rows = 60, fewest_parts = 5, fewest_runs = 4;
constexpr double delay_nats = 2.0, acting_nats = 6.0;

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

/// Whether sample k follows sample k - 1: no gap, no missing value.
bool follows(const Trajectory& run, Index k, double period_s) {
  return run.time_s(k) - run.time_s(k - 1) < 1.5 * period_s && run.states().col(k).allFinite() &&
         run.inputs().col(k).allFinite();
}

/// Samples first to first + count - 1 of a run.
struct Segment {
  const Trajectory* run;
  Index first, count, part;
};

/// Samples between gaps of the training runs, where at least 60 rows are left. The part is the number of the run.
std::vector<Segment> segments_of(const Recording& recording, Index first) {
  const double period_s = recording.median_period_s();
  std::vector<Segment> segments;
  Index runs = 0;
  for (const Trajectory& run : recording.runs) {
    Index begin = 0;
    for (Index k = 1; k <= run.samples() && run.role == Role::train; ++k) {
      if (k < run.samples() && follows(run, k, period_s)) continue;
      if (k - begin > first + least_rows) segments.push_back({&run, begin, k - begin, runs});
      begin = k;
    }
    if (!segments.empty() && segments.back().part == runs) ++runs;
  }
  return segments;
}

/// Cuts segments into at least five parts. Each part begins with samples of the part before, as its past.
std::vector<Segment> cut(const std::vector<Segment>& segments, Index first) {
  std::vector<Segment> parts;
  const Index count = std::ssize(segments);
  for (const Segment& segment : segments) {
    const Index rows = segment.count - 1 - first;
    const Index pieces = std::clamp<Index>(rows / least_rows, 1, (fewest_parts + count - 1) / count);
    for (Index p = 0; p < pieces; ++p)
      parts.push_back({segment.run, segment.first + rows * p / pieces,
                       rows * (p + 1) / pieces - rows * p / pieces + first + 1, std::ssize(parts)});
  }
  return parts;
}

/// Levels or differences of the same samples. The first sample of each segment has no difference.
ArmaxData data_of(const std::vector<Segment>& segments, Index first, bool differences) {
  ArmaxData data{{}, differences, {}, first};
  for (const Segment& segment : segments) {
    const Index N = segment.count - 1;
    const auto form = [&](const MatrixXd& of) {
      const MatrixXd now = of.middleCols(segment.first + 1, N);
      return differences ? MatrixXd(now - of.middleCols(segment.first, N)) : now;
    };
    data.stretches.push_back({form(segment.run->states()), form(segment.run->inputs()), {}, segment.part});
    data.begin.push_back(data.count);
    data.rows.push_back(N - first);
    data.count += N - first;
  }
  return data;
}

/// Subtracts the mean of a signal from all stretches.
VectorXd centre(ArmaxData& data, MatrixXd ArmaxStretch::*signal) {
  VectorXd sum = VectorXd::Zero((data.stretches.front().*signal).rows());
  double samples = 0.0;
  for (const ArmaxStretch& stretch : data.stretches)
    sum += (stretch.*signal).rowwise().sum(), samples += static_cast<double>((stretch.*signal).cols());
  for (ArmaxStretch& stretch : data.stretches) (stretch.*signal).colwise() -= sum / samples;
  return sum / samples;
}

/// Half the deviance of a structure for any delays, by least squares from sums of products. Lagged residuals of the
/// long ARX serve as noise.
class DelayScan {
 public:
  DelayScan(const ArmaxData& data, const ArmaxOrder& order, const Delays& least)
      : data_(data), order_(order), least_(least), all_(order) {
    all_.input_lags += longest_delay;
    gram_ = armax_gram(data, all_, least, data.first);
  }

  /// For the delays of one input from its least on. Only the least is finite for an input that hardly acts.
  VectorXd profile(Delays delays, std::size_t input) const {
    VectorXd half(longest_delay + 1 - least_[input]);
    for (Index k = 0; k < half.size(); ++k) {
      delays[input] = least_[input] + k;
      half(k) = half_deviance(delays);
    }
    if (half.maxCoeff() < half.minCoeff() + acting_nats) half.tail(half.size() - 1).setConstant(HUGE_VAL);
    return half;
  }

 private:
  const ArmaxData& data_;
  const ArmaxOrder& order_;
  const Delays& least_;
  ArmaxOrder all_;
  MatrixXd gram_;

  double half_deviance(const Delays& delays) const {
    const Index n = data_.states(), inputs = n * order_.state_lags, targets = gram_.rows() - n;
    std::vector<Index> used;
    for (Index j = 0; j < inputs; ++j) used.push_back(j);
    for (std::size_t i = 0; i < delays.size(); ++i)
      for (Index j = delays[i] - least_[i], end = j + order_.input_lags; j < end; ++j)
        used.push_back(inputs + j * data_.inputs() + static_cast<Index>(i));
    for (Index j = inputs + data_.inputs() * all_.input_lags; j < targets; ++j) used.push_back(j);
    const auto z = Eigen::seqN(targets, n);
    const MatrixXd rest = gram_(z, z) - gram_(z, used) * solve_scaled(gram_(used, used), gram_(used, z));
    const auto rows = static_cast<double>(data_.count);
    return 0.5 * rows * log_determinant(rest / rows);
  }
};

/// Delays of a structure, one input at a time: the latest within 2 nats. With a fit, the likelihood decides among the
/// delay of the fit and the best by least squares.
Delays found_delays(const ArmaxData& data, const Delays& least, const ArmaxFit* fit) {
  constexpr int proposals = 3;
  const ArmaxOrder order = fit ? fit->order : ArmaxOrder{data.differences, 2, 2, data.differences ? 3 : 2};
  const DelayScan scan(data, order, least);
  Delays delays = fit ? fit->delays : least;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    VectorXd half = scan.profile(delays, i), exact = VectorXd::Constant(half.size(), HUGE_VAL);
    Index at = delays[i] - least[i];
    for (int proposal = 0; fit && proposal <= proposals && (proposal == 0 || half(at) < HUGE_VAL); ++proposal) {
      delays[i] = least[i] + at;
      exact(at) = 0.5 * static_cast<double>(data.count) * log_determinant(fit_armax(data, order, delays).S);
      half(at) = HUGE_VAL;
      half.minCoeff(&at);
    }
    const VectorXd& decides = fit ? exact : half;
    for (Index k = 0; k < half.size(); ++k)
      if (decides(k) < decides.minCoeff() + delay_nats) delays[i] = least[i] + k;
  }
  return delays;
}

ArmaxCandidate candidate(const ArmaxData& data, const ArmaxOrder& order, Index parts) {
  const Index n = data.states();
  LeftOut left;
  ArmaxCandidate result{fit_armax(data, order, data.delays, &left), VectorXd::Zero(parts), 0.0, 0};
  const MatrixXd& e = left.errors;
  result.size = n * (result.fit.theta.cols() + order.noise_lags * n);
  const MatrixXd S = e * e.transpose() / static_cast<double>(data.count), z = Cholesky(S).whiten(e);
  VectorXd density = VectorXd::Constant(data.count, -0.5 * log_determinant(S));
  for (Index i = 0; i < n; ++i) density += fitted_student_log_density(z.row(i).transpose(), 1e-3);
  for (std::size_t r = 0; r < data.stretches.size(); ++r)
    result.left_out(data.stretches[r].part) +=
        density.segment(data.begin[r], data.rows[r]).sum() - left.start_nats(static_cast<Index>(r));
  if (!result.left_out.allFinite()) result.left_out.setConstant(-1e100);  // errors that grew without bound
  return result;
}

/// Sets `lost` of the candidates, and chooses the smallest within the limits.
void choose(LinearStage& stage, Index states) {
  constexpr double least_per_row = 0.001, least_per_state = 6.0;
  std::vector<ArmaxCandidate>& all = stage.candidates;
  const auto best = std::ranges::max_element(all, {}, [](const ArmaxCandidate& a) { return a.left_out.sum(); });
  const double rows = stage.rows.sum();
  stage.chosen = static_cast<std::size_t>(best - all.begin());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const VectorXd lost = best->left_out - all[i].left_out;
    all[i].lost = lost.sum();
    const double error = clustered_error(lost, stage.rows) * rows;
    if (all[i].lost > std::max({error, least_per_row * rows, least_per_state * static_cast<double>(states)})) continue;
    const auto key = [&](std::size_t c) { return std::pair(all[c].size, all[c].lost); };
    if (key(i) < key(stage.chosen)) stage.chosen = i;
  }
}

/// The constant for y and u that are not centred, and the covariance with it.
void uncentre(ArmaxFit& fit, const VectorXd& mean_y, const VectorXd& mean_u) {
  if (!fit.order.has_constant()) return;
  const Index n = fit.theta.rows(), last = fit.theta.cols() - 1, q = last + 1 + n * fit.order.noise_lags;
  VectorXd mean(last);
  mean << mean_y.replicate(fit.order.state_lags, 1), mean_u.replicate(fit.order.input_lags, 1);
  fit.theta.col(last) += mean_y - fit.theta.leftCols(last) * mean;
  MatrixXd& V = fit.covariance;
  for (Index i = 0; i < n; ++i) V.row(i * q + last) -= mean.transpose() * V.middleRows(i * q, last);
  for (Index i = 0; i < n; ++i) V.col(i * q + last) -= V.middleCols(i * q, last) * mean;
}

/// Structures whose parameters the rows determine; without inputs, those that are then equal are one.
std::vector<ArmaxOrder> orders_of(const LinearStageOptions& options, const ArmaxData& data) {
  std::vector<ArmaxOrder> result, asked(orders.begin(), orders.end());
  if (options.only) asked = {options.only->order};
  const Index n = data.states(), m = data.inputs();
  for (ArmaxOrder order : asked) {
    if (m == 0) order.input_lags = 0;
    if (!options.intercept) order.intercept = false;
    const Index columns = (order.state_lags + order.noise_lags) * n + order.input_lags * m + 1;
    if (4 * columns <= data.count && std::ranges::count(result, order) == 0) result.push_back(order);
  }
  return result;
}

using Forms = std::array<ArmaxData, 2>;  // levels and differences of the same samples

/// Fits all structures and chooses one.
void compare(LinearStage& stage, const Forms& forms, const std::vector<ArmaxOrder>& structures) {
  stage.candidates.resize(structures.size());
  tbb::parallel_for(std::size_t{0}, structures.size(), [&](std::size_t i) {
    const ArmaxData& data = forms[structures[i].differences ? 1 : 0];
    stage.candidates[i] = candidate(data, structures[i], stage.rows.size());
  });
  choose(stage, forms[0].states());
}

}  // namespace

LinearStage find_linear_stage(const Recording& recording, const LinearStageOptions& options) {
  Delays least = options.least_delay;
  least.resize(static_cast<std::size_t>(recording.input_count()), 1);
  Index first = least_first;
  for (const Index delay : least) first = std::max(first, delay + longest_delay + 8);
  LinearStage stage;
  std::vector<Segment> segments = segments_of(recording, first);
  stage.by_runs = !segments.empty() && segments.back().part + 1 >= fewest_runs;
  if (!stage.by_runs && !segments.empty()) segments = cut(segments, first);
  if (segments.size() < 2) return stage;
  Forms forms{{data_of(segments, first, false), data_of(segments, first, true)}};
  const bool centred = options.only ? options.only->order.intercept : options.intercept;
  const auto mean_of = [&](auto signal) { return centred ? centre(forms[0], signal) : VectorXd(); };
  const VectorXd mean_y = mean_of(&ArmaxStretch::y), mean_u = mean_of(&ArmaxStretch::u);
  const std::vector<ArmaxOrder> structures = orders_of(options, forms[0]);
  VectorXd moved = VectorXd::Zero(recording.state_count());
  for (const ArmaxStretch& stretch : forms[1].stretches) moved += stretch.y.cwiseAbs().rowwise().sum();
  if (structures.empty() || !(moved.minCoeff() > 0.0)) return stage;
  stage.rows.setZero(segments.back().part + 1);
  for (std::size_t r = 0; r < segments.size(); ++r)
    stage.rows(segments[r].part) += static_cast<double>(forms[0].rows[r]);
  for (ArmaxData& data : forms) {
    add_residuals(data, least);
    data.delays = options.only ? options.only->delays : found_delays(data, least, nullptr);
  }
  compare(stage, forms, structures);
  if (!options.only) {
    interruption_point();
    const ArmaxFit fit = stage.fit();
    const Delays found = found_delays(forms[fit.order.differences ? 1 : 0], least, &fit);
    for (ArmaxData& data : forms) data.delays = found;
    if (found != fit.delays) compare(stage, forms, structures);
  }
  for (ArmaxCandidate& one : stage.candidates) uncentre(one.fit, mean_y, mean_u);
  return stage;
}

}  // namespace modebank
