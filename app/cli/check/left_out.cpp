#include "app/cli/check/left_out.hpp"

#include <algorithm>
#include <cmath>

#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Every part needs its own learning, so more parts would cost more than they are worth.
constexpr Index most_parts = 3;

/// Whether periods are equal. The tolerance allows for rounded rates.
bool as_long(double a, double b) { return std::abs(a - b) <= 0.02 * b; }

/// The recording as `run` would import it if the part were held out.
ValidationSplit split_of(const DataOptions& data, const LeftOutPlan& plan, std::size_t part) {
  DataOptions options = data;
  options.test = plan.parts[part];
  options.train.clear();
  for (const std::string& run : plan.runs)
    if (std::find(options.test.begin(), options.test.end(), run) == options.test.end()) options.train.push_back(run);
  const Recording recording = import_data(options).recording;
  ValidationSplit split{{recording.states, recording.inputs, {}, recording.quantum},
                        {recording.states, recording.inputs, {}, recording.quantum}};
  for (const Trajectory& run : recording.runs)
    (run.role == Role::train ? split.training : split.left_out).runs.push_back(run);
  return split;
}

std::vector<ValidationSplit> splits_of(const DataOptions& data, const LeftOutPlan& plan) {
  if (plan.parts.empty()) return validation_splits(import_data(data).recording, most_parts);
  std::vector<ValidationSplit> splits;
  for (std::size_t part = 0; part < plan.parts.size(); ++part) splits.push_back(split_of(data, plan, part));
  return splits;
}

/// Number of samples in a time of `common_s`; 0 if this is not a whole number.
Index samples_ahead(double common_s, double period_s) {
  const double ahead = std::round(common_s / period_s);
  return ahead >= 1.0 && as_long(ahead * period_s, common_s) ? static_cast<Index>(ahead) : 0;
}

/// Index of the run to which a part belongs. A part has a name such as RUN.2 or RUN[40].
std::size_t owner_of(const std::string& part, const std::vector<std::string>& runs) {
  std::size_t owner = runs.size();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string& run = runs[i];
    const bool fits =
        part.rfind(run, 0) == 0 && part.find_first_not_of(".[]0123456789", run.size()) == std::string::npos;
    if (fits && (owner == runs.size() || run.size() > runs[owner].size())) owner = i;
  }
  return owner;
}

VectorXd joined(const std::vector<const VectorXd*>& pieces) {
  Index size = 0;
  for (const VectorXd* piece : pieces) size += piece->size();
  VectorXd all(size);
  Index at = 0;
  for (const VectorXd* piece : pieces) {
    all.segment(at, piece->size()) = *piece;
    at += piece->size();
  }
  return all;
}

/// Joins the parts of one run in the order of time.
LeftOutRun in_one(std::vector<LeftOutRun> parts) {
  std::erase_if(parts, [](const LeftOutRun& part) { return part.time_s.size() == 0; });
  std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.time_s(0) < b.time_s(0); });
  std::vector<const VectorXd*> time_s, one_step, common_step;
  for (const LeftOutRun& part : parts) {
    time_s.push_back(&part.time_s);
    one_step.push_back(&part.one_step);
    common_step.push_back(&part.common_step);
  }
  return {joined(time_s), joined(one_step), joined(common_step), {}};
}

LeftOut predict_all(const ChainOptions& options, const LeftOutPlan& plan, double common_s) {
  const std::vector<ValidationSplit> splits = splits_of(options.data, plan);
  if (splits.empty()) throw DataError("there is nothing to leave out");
  LeftOut left_out;
  left_out.period_s = splits.front().training.median_period_s();
  const Index ahead = samples_ahead(common_s, left_out.period_s);
  std::vector<std::vector<LeftOutRun>> of_runs(plan.runs.size());
  for (std::vector<LeftOutRun>& part : predict_left_out(splits, learning_inputs(options), options.filter, ahead))
    for (LeftOutRun& run : part) of_runs.at(owner_of(run.run, plan.runs)).push_back(std::move(run));
  for (std::vector<LeftOutRun>& parts : of_runs) left_out.runs.push_back(in_one(std::move(parts)));
  return left_out;
}

/// Index of the time that is nearest to `at_s`; -1 if no time is within half a period.
Index nearest(const VectorXd& time_s, double at_s, double period_s) {
  const double* const begin = time_s.data();
  const Index after = std::lower_bound(begin, begin + time_s.size(), at_s) - begin;
  Index best = after < time_s.size() ? after : after - 1;
  if (after > 0 && best >= 0 && at_s - time_s(after - 1) < std::abs(time_s(best) - at_s)) best = after - 1;
  constexpr double half = 0.5 + 1e-6;
  return best >= 0 && std::abs(time_s(best) - at_s) <= half * period_s ? best : -1;
}

/// Pairs of log densities of one run. Each sample of the slower rate is paired with the nearest sample of the faster
/// rate.
struct Beside {
  VectorXd slower, faster;
};
Beside beside(const LeftOutRun& slower, const LeftOutRun& faster, bool one_step, double period_s) {
  const VectorXd& a = one_step ? slower.one_step : slower.common_step;
  const VectorXd& b = one_step ? faster.one_step : faster.common_step;
  Beside pair{VectorXd::Constant(slower.time_s.size(), not_a_number),
              VectorXd::Constant(slower.time_s.size(), not_a_number)};
  if (a.size() != slower.time_s.size() || b.size() != faster.time_s.size()) return pair;
  pair.slower = a;
  for (Index k = 0; k < slower.time_s.size(); ++k)
    if (const Index at = nearest(faster.time_s, slower.time_s(k), period_s); at >= 0) pair.faster(k) = b(at);
  return pair;
}

}  // namespace

LeftOutPlan plan_left_out(const DataCheck& check) {
  LeftOutPlan plan;
  std::vector<Index> transitions;
  for (const RunReport& run : check.runs) {
    if (run.role != Role::train) continue;
    plan.runs.push_back(run.run);
    transitions.push_back(run.transitions);
  }
  if (std::ssize(plan.runs) < refine_tuning.fewest_whole_runs) return plan;
  plan.parts.resize(most_parts);
  const std::vector<Index> part = deal_by_length(transitions, most_parts);
  for (std::size_t i = 0; i < part.size(); ++i) plan.parts[static_cast<std::size_t>(part[i])].push_back(plan.runs[i]);
  return plan;
}

LeftOut predict_left_out(const ChainOptions& options, const LeftOutPlan& plan, double common_s) {
  try {
    return predict_all(options, plan, common_s);
  } catch (const ConfigurationError& error) {
    return {{}, 0.0, error.what()};
  } catch (const DataError& error) {
    return {{}, 0.0, error.what()};
  }
}

PairedGain compare_left_out(const LeftOut& better, const LeftOut& other) {
  constexpr double enough = 0.5;
  const bool one_step = as_long(better.period_s, other.period_s), better_is_slower = better.period_s > other.period_s;
  const LeftOut &slower = better_is_slower ? better : other, &faster = better_is_slower ? other : better;
  std::vector<VectorXd> of_better, of_other;
  double scored = 0.0;
  for (std::size_t r = 0; r < slower.runs.size(); ++r) {
    Beside pair = beside(slower.runs[r], faster.runs[r], one_step, faster.period_s);
    scored += static_cast<double>((!pair.slower.array().isNaN()).count());
    of_better.push_back(better_is_slower ? pair.slower : pair.faster);
    of_other.push_back(better_is_slower ? std::move(pair.faster) : std::move(pair.slower));
  }
  PairedGain gain = paired_gain("", of_better, of_other);
  if (!(static_cast<double>(gain.samples) >= enough * scored)) gain.gain = gain.standard_error = not_a_number;
  return gain;
}

}  // namespace modebank
