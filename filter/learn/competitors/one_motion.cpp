#include <vector>

#include "filter/learn/competitors/noise_by_input.hpp"
#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/learn.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// The fields of the windows that refinement of a linear model uses.
WindowFits linear_frame(const WindowFits& fits, const GlobalModel& global) {
  WindowFits frame;
  frame.structure = fits.structure;
  frame.length = fits.length;
  frame.step = fits.step;
  frame.global = global;
  // The prior of a motion model concerns other parameters.
  if (fits.model_parameters.empty()) frame.prior_sd = fits.prior_sd;
  return frame;
}

/// The frame with the noises and the transitions of `rival`, and one theta.
Bank with_noises_of(const Bank& rival, Bank frame, const GlobalModel& global) {
  const Index n = frame.structure.states, p = frame.structure.parameters();
  frame.modes.clear();
  for (const Mode& mode : rival.modes)
    frame.modes.push_back(make_mode(frame.structure, global.theta, mode.Q.topLeftCorner(n, n),
                                    Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), mode.weight));
  set_mode_sequence(frame, rival.transition);
  return frame;
}

}  // namespace

std::vector<Bank> level_starts(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                               Index most, double kept, const NoiseFactor& factor) {
  std::vector<Bank> starts;
  for (Index levels = most; levels >= 1; levels = static_cast<Index>(kept * static_cast<double>(levels)))
    starts.push_back(learn_noise_levels(recording, structure, R, levels, factor));
  return starts;
}

Refinement learn_one_motion(const Recording& recording, const WindowFits& fits, const GlobalModel& global,
                            const Bank& rival, const Eigen::MatrixXd& R, Index most_levels,
                            const BankOptions& options) {
  RefineOptions em = options.em;
  em.one_theta = true;
  em.state_dependent_transition = options.transition == TransitionSource::logit;
  em.restarts = 0;  // random stretches differ in theta, but this model has one theta
  em.measurement_noise = em.measurement_noise && !options.measurement_variance;
  std::vector<Bank> starts =
      level_starts(recording, fits.structure, stated_or(options, R), most_levels, refine_tuning.modes_kept,
                   em.noise_by_input ? fit_noise_factor(recording, fits.structure) : NoiseFactor());
  if (rival.mode_count() > 1) starts.push_back(with_noises_of(rival, starts.front(), global));
  Refinement learned = refine_bank(recording, linear_frame(fits, global), starts, em, FilterOptions{});
  clear_unidentifiable(learned.bank, global.covariance);
  return learned;
}

}  // namespace modebank
