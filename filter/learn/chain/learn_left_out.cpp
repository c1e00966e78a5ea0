#include "filter/learn/chain/learn_left_out.hpp"

#include <tbb/parallel_for.h>

#include <exception>

#include "filter/judge/run/horizon.hpp"
#include "filter/learn/chain/stages.hpp"

namespace modebank {
namespace {

Bank learn_on(const Recording& training, const LearningInputs& inputs) {
  const Progress silent;
  const FitOptions& window = inputs.bank.window;
  const WindowFits windows = fit_windows(training, window);
  const MixtureResult mixture = cluster(training, windows, inputs.mixture, silent);
  const auto motion = motion_model(window, training.state_count(), training.input_count());
  const Bank baseline =
      learn_single_filter(training, one_model(training, windows, motion.get(), {}), inputs.competitors.filter, silent);
  return learn_modes({training, windows, mixture, baseline, motion.get()}, inputs.bank, silent).bank;
}

LeftOutRun predict(const Bank& bank, const Trajectory& run, const FilterOptions& filter, Index ahead) {
  std::vector<Index> horizons{1};
  if (ahead > 1) horizons.push_back(ahead);
  const HorizonEvaluation said = evaluate_horizons(bank, run, filter, horizons);
  LeftOutRun predicted{run.time_s, said.log_density.row(0), {}, run.run};
  if (ahead > 0) predicted.common_step = said.log_density.row(said.log_density.rows() - 1);
  return predicted;
}

}  // namespace

std::vector<std::vector<LeftOutRun>> predict_left_out(const std::vector<ValidationSplit>& splits,
                                                      const LearningInputs& inputs, const FilterOptions& filter,
                                                      Index ahead) {
  std::vector<std::vector<LeftOutRun>> said(splits.size());
  std::vector<std::exception_ptr> errors(splits.size());
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t part) {
    try {
      const Bank bank = learn_on(splits[part].training, inputs);
      for (const Trajectory& run : splits[part].left_out.runs) said[part].push_back(predict(bank, run, filter, ahead));
    } catch (const std::exception&) {
      errors[part] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)  // throws the first exception in order, independent of timing
    if (error) std::rethrow_exception(error);
  return said;
}

}  // namespace modebank
