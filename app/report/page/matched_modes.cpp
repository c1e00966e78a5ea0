#include "app/report/page/matched_modes.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/distributions.hpp"
#include "mixture/assignment.hpp"

namespace modebank::app::report {
namespace {

using Eigen::Index;

/// Parameters of a mode as on the page, with their standard errors. A standard error of 0 means that it is unknown.
struct Estimates {
  Eigen::VectorXd values, errors;
};

bool usable(double error) { return std::isfinite(error) && error > 0.0; }

Estimates estimates_of(const Bank& bank, Index k) {
  const Mode& mode = bank.modes[static_cast<std::size_t>(k)];
  const bool motion = !bank.motion_parameters.empty();
  Estimates estimates{motion ? mode.motion_theta : bank.theta(k), {}};
  const Eigen::VectorXd& stated = motion ? mode.motion_standard_error : mode.standard_error;
  estimates.errors = Eigen::VectorXd::Zero(estimates.values.size());
  const bool some = std::any_of(stated.begin(), stated.end(), usable);  // if any parameter has a standard error, one
                                                                        // without is unidentifiable
  for (Index i = 0; i < estimates.errors.size(); ++i) {
    if (i < stated.size() && usable(stated(i)))
      estimates.errors(i) = stated(i);
    else if (!some && !motion && i < mode.parameter_covariance.rows() && usable(mode.parameter_covariance(i, i)))
      estimates.errors(i) = std::sqrt(mode.parameter_covariance(i, i));
  }
  return estimates;
}

MatchedMode pair_of(const Bank& first, Index a, const Bank& second, Index b) {
  const Estimates one = estimates_of(first, a), other = estimates_of(second, b);
  MatchedMode pair{a, b, Eigen::VectorXd::Zero(one.values.size())};
  Index counted = 0;
  for (Index i = 0; i < pair.z.size(); ++i) {
    const double error = std::hypot(one.errors(i), other.errors(i));
    if (error <= 0.0) continue;
    pair.z(i) = (other.values(i) - one.values(i)) / error;
    ++counted;
  }
  pair.distance = counted > 0 ? std::sqrt(pair.z.squaredNorm() / static_cast<double>(counted)) : 0.0;
  return pair;
}

/// Reason why the parameters of two banks cannot be compared; empty if they can.
std::string obstacle(const Bank& first, const Bank& second) {
  if (first.model != second.model) return "their models differ: " + first.model + " and " + second.model;
  if (first.theta(0).size() != second.theta(0).size() || first.state_names != second.state_names ||
      first.input_names != second.input_names)
    return "their models have different parameters";
  return "";
}

/// How near the modes of two banks are, by their parameters. Larger values are nearer.
Eigen::MatrixXd nearness(const Bank& first, const Bank& second) {
  Eigen::MatrixXd near(first.mode_count(), second.mode_count());
  for (Index a = 0; a < near.rows(); ++a)
    for (Index b = 0; b < near.cols(); ++b) {
      const double distance = pair_of(first, a, second, b).distance;
      near(a, b) = -std::log1p(distance * distance);
    }
  return near;
}

/// Whether two modes share time, and at least one of them shares its most time with the other.
bool go_together(const Eigen::MatrixXd& shared, Index a, Index b) {
  const double time = shared(a, b);
  return time > 0.0 && (time == shared.row(a).maxCoeff() || time == shared.col(b).maxCoeff());
}

}  // namespace

bool MatchedMode::agree() const {
  if (z.size() == 0) return false;
  const double limit = normal_quantile(1.0 - 0.025 / static_cast<double>(z.size()));
  return z.cwiseAbs().maxCoeff() <= limit;
}

ModeMatch match_modes(const Bank& first, const Bank& second, const Eigen::MatrixXd& shared) {
  ModeMatch match;
  match.by_time = shared.size() > 0 && shared.sum() > 0.0;
  match.difference = obstacle(first, second);
  const bool comparable = match.difference.empty();
  if (!comparable && !match.by_time) return match;
  const Index K = first.mode_count(), L = second.mode_count(), most = std::max(K, L);
  // The padding has the same merit for every mode, so it does not affect the match.
  Eigen::MatrixXd merit = Eigen::MatrixXd::Zero(most, most);
  merit.topLeftCorner(K, L) = match.by_time ? shared : nearness(first, second);
  const std::vector<Index> column = best_assignment(merit);
  std::vector<MatchedMode> alone;
  for (Index a = 0; a < most; ++a) {
    const Index b = column[static_cast<std::size_t>(a)];
    const bool both = a < K && b < L;
    if (both && (!match.by_time || go_together(shared, a, b))) {
      match.modes.push_back(comparable ? pair_of(first, a, second, b) : MatchedMode{a, b, {}});
      if (match.by_time) match.modes.back().shared = shared(a, b);
      continue;
    }
    if (a < K) match.modes.push_back({a, -1, {}});
    if (b < L) alone.push_back({-1, b, {}});
  }
  match.modes.insert(match.modes.end(), alone.begin(), alone.end());
  return match;
}

}  // namespace modebank::app::report
