// The public API of learning, from runs to a bank: converts between plain vectors and Eigen.
#include "ident/base/api.hpp"

#include <memory>
#include <utility>

#include "filter/learn/chain/chain.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "ident/data/public_recording.hpp"
#include "ident/data/streams.hpp"
#include "ident/fit/fit_windows.hpp"
#include "mixture/from_internal.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/learn/learn.hpp"

namespace modebank::learn {

namespace {

/// One column per mode.
template <class Column>
Matrix columns(const modebank::Bank& bank, Column column) {
  Eigen::MatrixXd all(column(bank.modes.front()).size(), bank.mode_count());
  for (Index k = 0; k < all.cols(); ++k) all.col(k) = column(bank.modes[static_cast<std::size_t>(k)]);
  return to_matrix(all);
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

/// Runs the chain of `modebank run`. `own`: the caller's motion model, or null.
Learned learn_from(const Recording& recording, const LearnOptions& options, const MotionModel* own) {
  LearningOptions learning{options.window, options.mixture, options.bank, options.filter, {}, options.seed};
  const bool searched = options.search_lags && !own && is_linear(options.window);
  learning.searched_lags = {searched, searched, searched};
  learning.automatic_windows = {options.automatic_length, options.automatic_step};
  learning.competitors = false;  // this API does not return competitors
  std::vector<const Eigen::VectorXd*> times;
  for (const Trajectory& run : recording.runs) times.push_back(&run.time_s);
  learning.one_model = step_scatter(times) > most_step_scatter;

  Origin origin;
  LearningHooks hooks;
  hooks.motion = own;
  hooks.refined = [&](const Refinement& refined) {
    origin.refinements = refined.candidates;
    origin.objective = refined.objective;
    origin.measurement = refined.measurement;
  };
  Learning learned;
  learn_all(recording, learning, Stage::bank, hooks, learned);
  origin.features = learned.mixture->feature_names;
  origin.mixture = from_internal(learned.mixture->mixture);
  origin.candidates = learned.mixture->candidates;
  origin.labels.assign(learned.mixture->labels.begin(), learned.mixture->labels.end());
  origin.screened = learned.bank->screened;
  return {filter::Bank(std::make_shared<const modebank::Bank>(*learned.bank)),
          filter::Bank(std::make_shared<const modebank::Bank>(*learned.baseline)),
          training_log_likelihood(*learned.bank, recording, options.filter),
          training_log_likelihood(*learned.baseline, recording, {FilterVariant::kf}),
          uncertainty_of(*learned.bank),
          std::move(origin)};
}

}  // namespace

Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options) {
  return api_call([&] { return learn_from(to_recording(runs), options, nullptr); });
}

Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options, const MotionModel& model) {
  return api_call([&] {
    const Recording recording = to_recording(runs);
    LearnOptions fitting = options;
    fitting.window = options_for(model, recording, std::move(fitting.window));
    return learn_from(recording, fitting, &model);
  });
}

}  // namespace modebank::learn
