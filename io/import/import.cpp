#include "io/import/import.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "ident/base/printable.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/lag/choice.hpp"
#include "io/files/run_names.hpp"
#include "io/import/import_plan.hpp"
#include "io/import/label_streams.hpp"
#include "io/import/missing_values.hpp"
#include "io/import/quanta.hpp"
#include "io/import/read_runs.hpp"
#include "io/import/run_roles.hpp"
#include "io/import/sampling.hpp"
#include "io/import/split.hpp"
#include "io/import/value_check.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Sets units from the options. Units that the options lack come from the files.
void check_units(const char* key, const std::vector<std::string>& names, const std::vector<std::string>& units) {
  if (units.size() > 1 && units.size() != names.size())
    throw ConfigurationError(fmt::format(
        "data.{0}_unit has {1} units, but data.{0} has {2} columns; give one unit each, one for all, or none", key,
        units.size(), names.size()));
}

std::vector<Channel> with_units(std::vector<Channel> channels, const std::vector<std::string>& units) {
  for (std::size_t i = 0; i < channels.size() && !units.empty(); ++i)
    channels[i].unit = units[units.size() == 1 ? 0 : i];
  return channels;
}

/// Control characters are replaced, because a terminal would execute them.
void refuse_control_characters(const std::vector<Channel>& channels) {
  for (const Channel& channel : channels)
    if (const std::string text = channel.name + channel.unit; std::any_of(text.begin(), text.end(), is_control))
      throw DataError(fmt::format(
          "the column \"{}\" (unit \"{}\") has a control character in its name or unit; rename it in the file",
          printable(channel.name), printable(channel.unit)));
}

/// The content of one plan, or the error of reading it. If several plans fail, the first error in their order is
/// reported.
struct Outcome {
  FileContent content;
  std::exception_ptr error;
};

Outcome try_read(const FilePlan& plan, const DataOptions& options, bool as_they_stand) {
  Outcome outcome;
  try {
    read_runs(plan, options, outcome.content);
    for (RunStreams& run : outcome.content.runs) {
      check_values(run, options);
      for (std::string& text : run.label.text) text = printable_name(text);
      if (!as_they_stand) put_in_order(run, options.disorder);
    }
  } catch (...) {
    outcome.error = std::current_exception();
  }
  return outcome;
}

/// Reads plans in parallel. The results keep the order of the plans, because the hash over all results depends on this
/// order. After an error no further plan starts, but running plans are completed.
/// An exception must not leave the pipeline: it would cancel the readers' own parallel work, which would then return
/// partial results.
std::vector<RunStreams> read_all(std::vector<FilePlan>& plans, const DataOptions& options, ImportedData& data,
                                 bool as_they_stand) {
  std::vector<RunStreams> runs;
  std::vector<FileStamps> forms;
  UnsetRows unset;
  std::vector<Outcome> outcomes(plans.size());  // the pipeline's items are indices
  std::size_t next = 0;
  std::exception_ptr error;
  std::map<std::string, std::size_t> missing_words;
  std::atomic<bool> failed = false;
  const auto take = [&](tbb::flow_control& flow) {
    if (next == plans.size() || failed) flow.stop();
    return next++;
  };
  const auto read = [&](std::size_t plan) {
    outcomes[plan] = try_read(plans[plan], options, as_they_stand);
    return plan;
  };
  std::optional<WorkCounter> counter;  // if there is only one file, its reader reports progress in rows
  if (plans.size() > 1) counter.emplace("files", plans.size());
  const auto collect = [&](std::size_t plan) {
    if (counter) counter->add();
    Outcome outcome = std::exchange(outcomes[plan], {});
    std::move(outcome.content.forms.begin(), outcome.content.forms.end(), std::back_inserter(forms));
    if (outcome.error && !error) error = outcome.error;
    failed = error != nullptr;
    if (failed) return;
    for (std::string& note : outcome.content.notes)
      if (std::find(data.notes.begin(), data.notes.end(), note) == data.notes.end())
        data.notes.push_back(std::move(note));
    for (const auto& [word, count] : outcome.content.missing_words) missing_words[word] += count;
    std::move(outcome.content.files.begin(), outcome.content.files.end(), std::back_inserter(data.files));
    unset.add(outcome.content.unset);
    std::move(outcome.content.runs.begin(), outcome.content.runs.end(), std::back_inserter(runs));
  };
  const auto in_flight = 2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  using tbb::filter_mode;
  tbb::parallel_pipeline(in_flight, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, take) &
                                        tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, read) &
                                        tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, collect));
  if (agree_on_stamps(forms, plans)) {  // also done after an error, because wrongly read stamps may have caused it
    data.files.clear();
    data.notes.clear();
    return read_all(plans, options, data, as_they_stand);
  }
  if (error) std::rethrow_exception(error);
  for (const auto& [word, count] : missing_words)
    data.notes.push_back(
        fmt::format("\"{}\" is read as a missing value {} time{} (data.na)", word, count, count == 1 ? "" : "s"));
  if (unset.count > 0) data.notes.push_back(unset.note());
  data.data_hash = data_hash(data.files);
  return runs;
}

template <class Run>
void sort_by_name(std::vector<Run>& runs) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.run < b.run; });
}

void set_roles(std::vector<RunStreams>& runs, const DataOptions& options) {
  const std::vector<std::optional<Role>> roles = assign_roles(run_names(runs), options.train, options.test);
  std::vector<RunStreams> kept;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!roles[i]) continue;
    runs[i].role = *roles[i];
    kept.push_back(std::move(runs[i]));
  }
  runs = std::move(kept);
}

/// Splits every run into blocks. Blocks have the roles of the split, unless data.train or data.test names runs.
void split_runs(std::vector<RunStreams>& runs, const DataOptions& options, std::vector<std::string>& notes) {
  std::vector<RunStreams> blocks;
  for (const RunStreams& run : runs) {
    std::vector<RunStreams> parts = split_run(run, options.split, options.rate_hz);
    notes.push_back(split_note(run, parts, options.split));
    std::move(parts.begin(), parts.end(), std::back_inserter(blocks));
  }
  runs = std::move(blocks);
  sort_by_name(runs);
  check_run_names(run_names(runs));
}

/// Counts the measured samples of the joined runs, and the measured samples that no part contains.
class LeftOut {
 public:
  void count(const Trajectory& run, const std::vector<Trajectory>& parts) {
    measured_ += measured(run);
    for (const Trajectory& part : parts) kept_ += measured(part);
  }
  /// Empty if every sample is used.
  std::string note(const DataOptions& options) const {
    if (kept_ == measured_) return "";
    std::vector<std::string> reasons;
    if (!options.where.empty()) reasons.emplace_back("data.where is false or missing there");
    if (options.missing == Missing::gap) reasons.emplace_back("values are missing beside them (data.missing = gap)");
    if (options.missing == Missing::predict) reasons.emplace_back("no input value comes before them");
    reasons.emplace_back("they are single samples between gaps");
    return fmt::format("{} of {} measured samples are left out: {}", measured_ - kept_, measured_,
                       fmt::join(reasons, ", or "));
  }

 private:
  Index measured_ = 0, kept_ = 0;

  static Index measured(const Trajectory& run) { return run.state.array().isFinite().colwise().any().count(); }
};

/// Call this after the roles are set. data.train and data.test may name whole runs or blocks of runs.
std::vector<Trajectory> without_missing_values(const Trajectory& run, const std::vector<bool>& kept, Missing missing,
                                               std::vector<std::string>& notes) {
  const bool predict = missing == Missing::predict;
  std::vector<Trajectory> parts = split_at_gaps(predict ? hold_missing_inputs(run) : run, predict, kept);
  if (parts.size() > 1)
    notes.push_back(fmt::format("run {} has gaps, so it is split into {} runs, {} to {}", run.run, parts.size(),
                                parts.front().run, parts.back().run));
  return parts;
}

/// All runs with a role, in name order.
std::vector<RunStreams> named_streams(std::vector<FilePlan>& plans, const DataOptions& options, ImportedData& data,
                                      bool as_they_stand) {
  std::vector<RunStreams> runs = read_all(plans, options, data, as_they_stand);
  sort_by_name(runs);
  check_run_names(run_names(runs));
  const bool split = options.split.kind != SplitKind::none;
  if (split) split_runs(runs, options, data.notes);
  if (!split || !options.train.empty() || !options.test.empty()) set_roles(runs, options);
  return runs;
}

LagReport find_lags(const std::vector<RunStreams>& streams, double rate_hz) {
  std::vector<RunPair> pairs;
  for (const RunStreams& run : streams) pairs.push_back({run.run, run.role, run.states.stream, run.inputs.stream});
  return choose_lag(pairs, {.rate_hz = rate_hz});
}

void mark_averaged(const AveragedColumns& averaged, Recording& recording) {
  for (const Index i : averaged.states) recording.states[static_cast<std::size_t>(i)].averaged = true;
  for (const Index i : averaged.inputs) recording.inputs[static_cast<std::size_t>(i)].averaged = true;
}

}  // namespace

ImportedData import_data(const DataOptions& options, const MemoryTables* memory, const AveragedColumns* learned) {
  ImportedData data;
  check_units("state", options.state, options.state_unit);
  check_units("input", options.input, options.input_unit);
  std::vector<FilePlan> plans = plan_import(options, memory);
  data.recording.states = with_units(plans.front().states, options.state_unit);
  data.recording.inputs = with_units(plans.front().inputs, options.input_unit);
  refuse_control_characters(data.recording.states);
  refuse_control_characters(data.recording.inputs);
  std::vector<RunStreams> streams = named_streams(plans, options, data, false);
  for (std::string& line : dominating_values(streams, options)) data.notes.push_back(std::move(line));
  const LogSampling sampling = choose_sampling(streams, options, learned, data.notes);
  mark_averaged(sampling.averaged, data.recording);
  data.step_scatter = sampling.step_scatter;
  if (options.lag_auto) data.lag = find_lags(streams, sampling.rate_hz);
  auto& runs = data.recording.runs;
  Quanta quanta(options);
  LabelHolder labels;
  LeftOut left_out;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    for (std::string& line : columns_without_value(streams[i], options)) data.notes.push_back(std::move(line));
    const Trajectory run = join_run(streams[i], options, sampling, data.lag ? data.lag->runs[i].applied_lag_s : 0.0);
    quanta.look_at(streams[i], run);
    std::vector<Trajectory> parts =
        without_missing_values(run, kept_samples(streams[i], run), options.missing, data.notes);
    left_out.count(run, parts);
    if (!options.label.empty()) labels.hold(streams[i].label, parts);
    std::move(parts.begin(), parts.end(), std::back_inserter(runs));
    streams[i] = {};
  }
  if (const std::string note = left_out.note(options); !note.empty()) data.notes.push_back(note);
  sort_by_name(runs);
  check_run_names(run_names(runs));
  if (!options.label.empty()) {
    data.labels = labels.of(runs);
    check_labels(options.label, *data.labels, data.notes);
  }
  data.recording.quantum = quanta.decide(data.recording, data.notes);
  return data;
}

std::vector<RunStreams> read_streams(const DataOptions& options) {
  ImportedData unused;
  DataOptions lenient = options;
  lenient.disorder = Disorder::sort;  // done for streams from several tables; a single table is checked later
  std::vector<FilePlan> plans = plan_import(lenient);
  refuse_control_characters(plans.front().states);
  refuse_control_characters(plans.front().inputs);
  for (FilePlan& plan : plans)
    for (SourcePlan& source : plan.sources) {
      source.request.may_miss.assign(source.request.numbers.size(), true);
      source.request.time.may_miss = true;
    }
  return named_streams(plans, lenient, unused, true);
}

std::vector<DataFile> data_files(const DataOptions& options) {
  std::vector<DataFile> files;
  for (const FilePlan& plan : plan_import(options))
    for (std::size_t path = 0; path < plan.paths.size(); ++path) {
      DataFile& file = files.emplace_back(DataFile{plan.paths[path]});
      const auto requests = plan.requests_of(path).requests;
      const std::vector<TableInfo> tables = plan.readers[path]->tables();
      for (const TableRequest& request : requests) file.tables.push_back(tables[request.table].name);
      std::sort(file.tables.begin(), file.tables.end());
      file.describe = [reader = plan.readers[path], requests] { return reader->describe(requests); };
    }
  return files;
}

}  // namespace modebank
