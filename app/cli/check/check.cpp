#include "app/cli/check/check.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "filter/learn/chain/inputs.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/lag/choice.hpp"
#include "io/import/import.hpp"
#include "io/import/missing_values.hpp"
#include "io/import/sampling.hpp"
#include "io/import/value_check.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

/// Intermediate results that several parts of the report use.
struct Material {
  std::vector<RunStreams> recorded;
  std::vector<RunPair> ordered;
  std::vector<Trajectory> parts;  // joined runs of all roles, each split at gaps
  LinearStructure structure;
  VectorXd still_level;                                      // per input
  std::vector<std::vector<bool>> states_rest, inputs_still;  // for each run and sample, true at rest
};

/// Joins the runs as if all correctable faults were corrected.
void join_parts(const CheckOptions& options, Material& material, DataCheck& check) {
  DataOptions lenient = options.data;
  lenient.missing = Missing::gap;
  lenient.disorder = Disorder::sort;
  lenient.lag_s = options.data.lag_auto ? 0.0 : options.data.lag_s;
  lenient.lag_auto = false;
  std::vector<RunStreams> ordered = material.recorded;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    ordered[i].states.stream = material.ordered[i].states;
    ordered[i].inputs.stream = material.ordered[i].inputs;
    ordered[i].truth.clear();
  }
  std::vector<std::string> notes;  // not used here: `run` prints these notes
  const LogSampling sampling = choose_sampling(ordered, lenient, nullptr, notes);
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    try {
      for (Trajectory& part : split_at_gaps(join_run(ordered[i], lenient, sampling, {}), false)) {
        RunReport& report = check.runs[i];
        const DeficientWindows windows = count_deficient_windows(part, options.window_length, material.structure);
        report.transitions += part.transitions();
        report.windows.windows += windows.windows;
        report.windows.deficient += windows.deficient;
        material.parts.push_back(std::move(part));
      }
    } catch (const DataError& error) {
      check.runs[i].problem = error.what();
    }
  }
}

std::vector<VectorXd> rows_of(const std::vector<RunPair>& runs, bool of_states, Index row) {
  std::vector<VectorXd> rows;
  for (const RunPair& run : runs) rows.push_back((of_states ? run.states : run.inputs).values.row(row));
  return rows;
}

double share_beyond(const VectorXd& values, const SaturationLimits& limits) {
  if (values.size() == 0) return 0.0;
  const auto beyond =
      (values.array() <= limits.low || values.array() >= limits.high).count();  // a comparison with NaN is false
  return static_cast<double>(beyond) / static_cast<double>(values.size());
}

VectorXd joined(const std::vector<VectorXd>& rows) {
  Index size = 0;
  for (const VectorXd& row : rows) size += row.size();
  VectorXd all(size);
  for (Index first = 0; const VectorXd& row : rows) {
    all.segment(first, row.size()) = row;
    first += row.size();
  }
  return all;
}

/// Checks one channel, first in each run and then over all runs.
void check_channels(const Material& material, const std::string& name, const std::string& unit, bool is_state,
                    Index row, DataCheck& check) {
  ChannelSummary& summary = check.channels.emplace_back();
  summary.channel = {name, unit};
  summary.is_state = is_state;
  const std::vector<VectorXd> rows = rows_of(material.ordered, is_state, row);
  const VectorXd all = joined(rows);
  summary.values = check_channel(all);
  summary.values.outliers = 0;
  summary.limits = saturation_limits(rows);
  if (summary.limits.soft && is_state)  // a smooth motion stays long near its turning points, which looks like a limit
    summary.limits = {not_a_number, not_a_number, false};
  summary.saturated = share_beyond(all, summary.limits);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    RunReport& run = check.runs[i];
    (is_state ? run.state : run.input).push_back(check_channel(rows[i]));
    (is_state ? run.state_saturated : run.input_saturated).push_back(share_beyond(rows[i], summary.limits));
    summary.values.outliers += (is_state ? run.state : run.input).back().outliers;
  }
}

void check_all_channels(const DataOptions& data, const Material& material, DataCheck& check) {
  const auto unit = [](const std::vector<std::string>& units, std::size_t i) {
    return units.empty() ? "" : units[std::min(i, units.size() - 1)];
  };
  for (std::size_t i = 0; i < data.state.size(); ++i)
    check_channels(material, data.state[i], unit(data.state_unit, i), true, static_cast<Index>(i), check);
  for (std::size_t i = 0; i < data.input.size(); ++i)
    check_channels(material, data.input[i], unit(data.input_unit, i), false, static_cast<Index>(i), check);
}

/// Share of repeated samples in motion, over all runs.
double repeats_of(const Material& material, bool is_state, Index row) {
  std::vector<bool> at_rest;
  for (const std::vector<bool>& rests : is_state ? material.states_rest : material.inputs_still)
    at_rest.insert(at_rest.end(), rests.begin(), rests.end());
  return repeats_in_motion(joined(rows_of(material.ordered, is_state, row)), at_rest);
}

void check_runs(Material& material, DataCheck& check) {
  VectorXd& still_level = material.still_level;
  still_level.resize(material.structure.inputs);
  for (Index i = 0; i < still_level.size(); ++i) {
    const ChannelCheck& values = check.channels[static_cast<std::size_t>(material.structure.states + i)].values;
    still_level(i) = still_share * std::max(std::abs(values.least), std::abs(values.largest));
  }
  for (const RunPair& run : material.ordered) {
    material.states_rest.push_back(resting_samples(run.states, run.inputs, still_level));
    material.inputs_still.push_back(still_samples(run.inputs, still_level));
  }
  for (std::size_t i = 0; i < check.channels.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const bool is_state = row < material.structure.states;
    check.channels[i].repeated = repeats_of(material, is_state, is_state ? row : row - material.structure.states);
  }
  tbb::parallel_for(std::size_t{0}, check.runs.size(), [&](std::size_t i) {
    RunReport& run = check.runs[i];
    const RunPair& pair = material.ordered[i];
    run.inputs = check_sampling(material.recorded[i].inputs.stream);
    run.states = check_sampling(material.recorded[i].states.stream);
    if (still_level.size() == 0) return;
    run.commands = check_commands(pair.inputs, still_level);
    run.rest = check_rest(pair.states, pair.inputs, still_level);
    run.excitation = excitation_order(pair.inputs.values);
  });
}

void check_lags(const CheckOptions& options, const Material& material, DataCheck& check) {
  const auto trains = [](const RunPair& run) { return run.role == Role::train; };
  check.has_lag =
      material.structure.inputs > 0 && std::any_of(material.ordered.begin(), material.ordered.end(), trains) &&
      std::all_of(check.runs.begin(), check.runs.end(), [](const RunReport& r) { return r.problem.empty(); });
  if (!check.has_lag) return;
  try {
    check.lag = choose_lag(material.ordered, {.rate_hz = options.data.rate_hz});
  } catch (const DataError&) {  // there are too few data for a fit; find_unusable reports this
    check.has_lag = false;
    return;
  }
  tbb::parallel_for(std::size_t{0}, check.runs.size(), [&](std::size_t i) {
    const bool estimated = material.ordered[i].role == Role::train;
    check.runs[i].lag = estimated ? check.lag.runs[i] : estimate_run(material.ordered[i], LagChoiceOptions{}.range_s);
  });
}

Recording training_of(const Material& material, const DataCheck& check) {
  Recording training;
  for (const ChannelSummary& summary : check.channels)
    (summary.is_state ? training.states : training.inputs).push_back(summary.channel);
  for (const Trajectory& part : material.parts)
    if (part.role == Role::train) training.runs.push_back(part);
  return training;
}

/// Reason why identification would fail; empty if it would succeed.
std::string find_unusable(const DataCheck& check, const Recording& training) {
  for (const RunReport& run : check.runs)
    if (!run.problem.empty()) return run.problem;
  if (check.longest_stretch < check.window_length)
    return fmt::format("the longest part of the training runs without a gap has {} transitions, fewer than one window",
                       check.longest_stretch);
  try {
    refuse_constant_states(training);
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

DataCheck check_data(const CheckOptions& options) {
  Material material;
  material.recorded = read_streams(options.data);
  material.structure = {static_cast<Index>(options.data.state.size()), static_cast<Index>(options.data.input.size()),
                        options.intercept};
  DataCheck check;
  check.window_length = options.window_length;
  check.dominating = dominating_values(material.recorded, options.data);
  for (const RunStreams& run : material.recorded) {
    material.ordered.push_back({run.run, run.role, in_order(run.states.stream), in_order(run.inputs.stream)});
    RunReport& report = check.runs.emplace_back();
    report.run = run.run;
    report.role = run.role;
    if (material.ordered.back().states.time_s.size() < 2 || material.ordered.back().inputs.time_s.size() < 2)
      throw DataError(fmt::format("run \"{}\" has fewer than two samples with different times", run.run));
  }
  join_parts(options, material, check);
  check_all_channels(options.data, material, check);
  check_runs(material, check);
  check_lags(options, material, check);
  const Recording training = training_of(material, check);
  for (const Trajectory& part : training.runs)
    check.longest_stretch = std::max(check.longest_stretch, part.transitions());
  check.unidentifiable_effects = unidentifiable_effects(training, material.structure);
  check.unusable = find_unusable(check, training);
  return check;
}

}  // namespace modebank
