#include "filter/learn/switching/shrinkage.hpp"

#include <utility>
#include <vector>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/mean_square_growth.hpp"
#include "filter/learn/switching/starts.hpp"

namespace modebank {
namespace {

/// Moves the modes `which` towards theta, by the share `share` of their distance.
SwitchingRegression moved(const SwitchingRegression& model, const std::vector<Index>& which,
                          const Eigen::VectorXd& theta, double share) {
  SwitchingRegression result = model;
  for (const Index j : which) result.theta.col(j) += share * (theta - model.theta.col(j));
  return result;
}

}  // namespace

SwitchingPrior towards_one_motion(SwitchingPrior prior, const TrainingTransitions& transitions,
                                  SwitchingRegression model, double theta_transitions, const RefineTuning& tuning) {
  if (!(theta_transitions > 0.0)) return prior;
  model.logit = {};
  model.theta.colwise() = prior.mean;
  ExpectationMaximisation one(transitions, prior, {.one_theta = true, .alternations = tuning.alternations},
                              std::move(model));
  for (Index i = 0; i < tuning.one_motion_iterations && !one.converged(); ++i) one.step();
  prior.mean = one.model().theta.col(0);
  prior.information += theta_transitions * unit_information(transitions, prior.noise, tuning.least_information);
  return prior;
}

std::optional<ShrunkModel> shrunk_to_stability(const LinearStructure& structure, const SwitchingRegression& model,
                                               const Eigen::VectorXd& theta, const RefineTuning& tuning) {
  const double most = 1.0 + tuning.growth_slack, growth = mean_square_growth(structure, model);
  const auto grows = [&](const SwitchingRegression& m) { return !(mean_square_growth(structure, m) <= most); };
  if (growth <= most) return std::nullopt;
  std::vector<Index> all, unstable;
  for (Index j = 0; j < model.modes(); ++j) {
    all.push_back(j);
    if (spectral_radius(unpack(structure, model.theta.col(j))) > 1.0 + spectral_radius_slack) unstable.push_back(j);
  }
  for (const std::vector<Index>& which : {unstable, all}) {
    if (grows(moved(model, which, theta, 1.0))) continue;
    double too_little = 0.0, enough = 1.0;
    while (enough - too_little > tuning.shrinkage_digits) {
      const double middle = 0.5 * (too_little + enough);
      (grows(moved(model, which, theta, middle)) ? too_little : enough) = middle;
    }
    return ShrunkModel{moved(model, which, theta, enough), {std::ssize(which), enough, growth}};
  }
  return std::nullopt;
}

}  // namespace modebank
