// The installed face of learning: from runs to a bank, plain vectors outside, Eigen inside.
#include "ident/base/door.hpp"

#include <memory>
#include <utility>

#include "filter/learn/from_mixture/cluster_windows.hpp"
#include "filter/learn/learn.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "ident/data/public_recording.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/linearise.hpp"
#include "mixture/outside.hpp"
#include "mixture/select.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/learn/learn.hpp"

namespace modebank::learn {

namespace {

filter::Bank opaque(modebank::Bank bank) {
  return filter::Bank(std::make_shared<const modebank::Bank>(std::move(bank)));
}

/// One column per mode.
template <class Column>
Matrix columns(const modebank::Bank& bank, Column column) {
  Matrix result;
  for (const modebank::Mode& mode : bank.modes) {
    const Eigen::VectorXd values = column(mode);
    result.rows = values.size();
    ++result.cols;
    result.values.insert(result.values.end(), values.begin(), values.end());
  }
  return result;
}

Uncertainty uncertainty_of(const modebank::Bank& bank) {
  Uncertainty result;
  result.parameter_names = bank.structure.parameter_names();
  result.theta = columns(bank, [&](const modebank::Mode& mode) { return pack(bank.structure, mode.model); });
  result.theta_standard_error = columns(bank, [](const modebank::Mode& mode) { return mode.standard_error; });
  for (const modebank::Mode& mode : bank.modes)
    if (mode.Q_standard_error.size() > 0) result.Q_standard_error.push_back(to_matrix(mode.Q_standard_error));
  result.R_standard_error = to_matrix(bank.R_standard_error);
  result.transition_standard_error = to_matrix(bank.transition_standard_error);
  for (const ModelParameter& parameter : bank.motion_parameters)
    result.motion_parameter_names.push_back(parameter.name);
  if (bank.motion_parameters.empty()) return result;
  result.motion_theta = columns(bank, [](const modebank::Mode& mode) { return mode.motion_theta; });
  result.motion_theta_standard_error =
      columns(bank, [](const modebank::Mode& mode) { return mode.motion_standard_error; });
  return result;
}

/// The chain's stages from windows to a bank. `own`: a motion model of the caller's, or null.
Learned learn_from(const Recording& recording, const LearnOptions& options, const MotionModel* own) {
  const FitOptions& window = options.window;
  const auto named = own ? nullptr : motion_model(window, recording.state_count(), recording.input_count());
  const MotionModel* const motion = own ? own : named.get();
  const WindowFits fits = own ? fit_windows(recording, window, *own) : fit_windows(recording, window);
  const MixtureResult mixture = cluster_windows(recording, fits, window, options.mixture, options.seed);
  Baseline baseline = learn_baseline(recording, linear_global(recording, fits, motion), fits.structure);
  baseline.bank.model = fits.model;
  const bool one_model = options.filter.variant == FilterVariant::kf;
  Refinement refined =
      one_model ? Refinement{baseline.bank, {}, {}, {}, {}}
                : learn_as_asked(recording, fits, mixture, options.bank, baseline.bank.R, options.filter, motion);
  const double log_likelihood = training_log_likelihood(refined.bank, recording, options.filter);
  Origin origin{fits.audit,
                mixture.feature_names,
                outside(mixture.mixture),
                mixture.candidates,
                {mixture.labels.begin(), mixture.labels.end()},
                refined.bank.screened,
                std::move(refined.candidates),
                std::move(refined.objective),
                refined.measurement};
  Uncertainty uncertainty = uncertainty_of(refined.bank);
  return {opaque(std::move(refined.bank)), opaque(std::move(baseline.bank)), log_likelihood,
          baseline.log_likelihood,         std::move(uncertainty),           std::move(origin)};
}

LearnOptions with_one_seed(LearnOptions options) {
  options.window.seed = options.bank.em.seed = options.seed;
  options.bank.em.most_modes = most_components(options.mixture.selection);
  return options;
}

}  // namespace

Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options) {
  return at_the_door([&] { return learn_from(to_recording(runs), with_one_seed(options), nullptr); });
}

Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options, const MotionModel& model) {
  return at_the_door([&] {
    const Recording recording = to_recording(runs);
    LearnOptions seeded = with_one_seed(options);
    seeded.window = options_for(model, recording, std::move(seeded.window));
    return learn_from(recording, seeded, &model);
  });
}

}  // namespace modebank::learn
