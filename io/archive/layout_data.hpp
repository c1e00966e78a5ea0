#pragma once

#include <string>
#include <vector>

#include "io/archive/archive.hpp"
#include "io/archive/bank/layout_bank.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/archive/bank/units.hpp"
#include "io/archive/groups/columns.hpp"
#include "io/archive/groups/over_runs.hpp"
#include "io/archive/stored.hpp"
#include "io/files/run_names.hpp"

/// Layout of provenance, data, and the results of data.lag_s = auto; see io/archive/layout.hpp.
namespace modebank::layout {

/// /provenance: versions of libraries and compiler as attributes.
/// - inputs: files that were read
/// - path: path of the file
/// - sha256: SHA-256 of the file's content
template <class Io, class P>
void exchange_provenance(Io& io, P& provenance) {
  io.attributes(provenance.versions);
  io.table("inputs", provenance.inputs, column("path", &InputFile::path), column("bytes", &InputFile::bytes, "byte"),
           column("sha256", &InputFile::sha256));
}

/// The root attributes, the configuration and the provenance; every archive has them.
/// - format: `modebank`
/// - created: UTC, ISO 8601
/// - config_hash: SHA-256 of the resolved keys that change results
/// - data_hash: SHA-256 of the data's content
/// - config: the fully resolved configuration, itself a valid configuration
template <class Io, class A>
void exchange_origin(Io& io, A& archive) {
  io.constant_attribute("format", std::string(archive_format));
  std::string version = schema_version;
  io.attribute("schema_version", version);
  io.attribute("modebank_version", archive.provenance.modebank_version);
  io.attribute("created", archive.provenance.created);
  io.attribute("command_line", archive.provenance.command_line);
  io.attribute("config_hash", archive.provenance.config_hash);
  io.attribute("data_hash", archive.provenance.data_hash);
  io.text("config", archive.config);
  io.group("provenance", {}, [&](auto& member) { exchange_provenance(member, archive.provenance); });
}

/// - state_averaged: names of the states that were averaged at data.rate_hz; all others are picked
/// - input_averaged: names of the inputs that were averaged at data.rate_hz; all others are picked
template <class Io, class R>
void exchange_channels(Io& io, R& recording) {
  const auto channels = [&](auto& list, const std::string& kind) {
    io.through(list, store_channels, restore_channels, [&](auto& stored) {
      io.attribute_texts(kind + "_names", stored.names);
      io.attribute_texts(kind + "_units", stored.units);
      io.optional_attribute_texts(kind + "_averaged", stored.averaged);
    });
  };
  channels(recording.states, "state");
  channels(recording.inputs, "input");
}

/// The arrays of one run.
/// - time: [s], from the run's time origin
/// - state: measured states; NaN: missing
/// - input: input that acts from this sample on
/// - truth: true states, if the data have them
/// - label: position in `label_names`; -1: unknown
template <class Io, class T, class L>
void exchange_run(Io& samples, T& run, L& label, const Units& units) {
  samples.field("time", run.time_s, {"S"}, {"s"}, rule::increasing);
  samples.field("state", run.state, {"S", "n"}, units.states(), rule::finite_or_missing);
  samples.field("input", run.input, {"S", "m"}, units.inputs(), rule::finite_or_missing);
  samples.optional_field("truth", run.truth, {"S", "n"}, units.states(), rule::finite_or_missing);
  samples.optional_field("label", label, {"S"});  // positions in `label_names`
}

/// `labels`: whether data.label is set.
/// /data: all samples of all runs, one run after another.
/// - runs: the rows of each run
/// - role: `train` or `test`
/// - first: row of the run's first sample
/// - lag_s: lag that was applied to the run's inputs
/// - time_origin_ns: the run's time 0, in nanoseconds since 1970; 0: no stamps
/// - step_scatter: scatter of the log's time steps divided by their median, if above 0.1
/// - label_names: the names that the numbers in `label` mean
/// - quantum: rounding step of each state's values; 0: continuous
template <class Io, class R, class L, class S>
void exchange_recording(Io& io, R& recording, L& labels, S& step_scatter) {
  exchange_channels(io, recording);
  std::vector<RunRow> rows = Io::reads ? std::vector<RunRow>() : store_runs(recording.runs);
  io.table("runs", rows, column("name", &RunRow::name), column("role", &RunRow::role),
           column("first", &RunRow::first).obeying(rule::not_negative),
           column("samples", &RunRow::samples).obeying(rule::not_negative),
           column("lag_s", &RunRow::lag_s, "s").obeying(rule::finite),
           column("time_origin_ns", &RunRow::time_origin_ns), column("file", &RunRow::file));
  io.attribute_unless(0.0, "step_scatter", step_scatter);
  std::vector<std::string> label_names = labels ? labels->names : std::vector<std::string>();
  io.optional_attribute_texts("label_names", label_names);
  io.set_size("n", recording.states.size());
  io.set_size("m", recording.inputs.size());
  const Units units(recording);
  io.optional_field("quantum", recording.quantum, {"n"}, units.states(), rule::not_negative);
  if constexpr (Io::reads) {
    io.finish([&] { recording.runs = restore_runs(rows); });
    if (!label_names.empty()) labels = RunLabels{label_names, std::vector<Eigen::VectorXi>(recording.runs.size())};
  }
  const bool labelled = labels && !label_names.empty();
  over_runs(io, rows_of(recording.runs.empty() ? std::vector<RunRow>() : rows), [&](auto& samples, std::size_t i) {
    Eigen::VectorXi label = labelled ? labels->of_runs[i] : Eigen::VectorXi();
    exchange_run(samples, recording.runs[i], label, units);
    if constexpr (Io::reads)
      if (labelled) samples.finish([&] { labels->of_runs[i] = restore_label(label, rows[i], label_names.size()); });
  });
}

/// /lag: result of data.lag_s = auto.
template <class Io, class P>
void exchange_pooled(Io& io, const std::string& name, P& pooled) {
  io.attribute(name, pooled.mean);
  io.attribute(name + "_standard_error", pooled.standard_error);
  io.attribute(name + "_between_runs_sd", pooled.between_sd);
  io.attribute(name + "_runs", pooled.count);
}

/// /lag: delays between inputs and states that `data.lag_s = auto` estimated, for all runs and for each run.
/// - correction: the correction that was applied
/// - scores: one row for each correction that was compared
/// - runs: estimates of each run, and the lag that was applied to the run
/// - gain: log score minus the log score without correction
/// - applied_lag_s: lag that was applied
template <class Io, class L>
void exchange_lag(Io& io, L& lag) {
  io.attribute("correction", lag.correction);
  exchange_pooled(io, "lag_s", lag.lag);
  io.table("scores", lag.scores, column("correction", &LagScore::correction),
           column("transitions", &LagScore::transitions), column("log_score", &LagScore::log_score, "nat"),
           column("rmse", &LagScore::rmse), column("gain", &LagScore::gain, "nat"),
           column("gain_standard_error", &LagScore::gain_standard_error, "nat"));
  io.table("runs", lag.runs, column("run", &RunLag::run), column("status", &RunLag::status),
           column("lag_s", &RunLag::lag_s, "s"), column("lag_standard_error_s", &RunLag::lag_standard_error_s, "s"),
           column("time_constant_s", &RunLag::time_constant_s, "s"), column("r_squared", &RunLag::r_squared),
           column("applied_lag_s", &RunLag::applied_lag_s, "s"));
}

/// /structure: lags and delay that `window.model = auto` or lags of `auto` chose.
/// - state_lags: state lags of windows and bank
/// - input_lags: input lags of windows and bank
/// - samples: transitions that the comparison used
/// - parts: number of training runs, or of stretches of these runs, that were held out in turn
/// - by_runs: 1: parts are runs; 0: parts are stretches
/// - structures: number of structures that were compared
/// - noise_lags: lags of C of the single linear model, an ARMAX; 0: it is an ARX
/// - differences: 1: that model is one of differences between samples
/// - scores: one row for each structure that was compared
/// - chosen: 1: windows and bank use this structure
/// - linear: 1: this is the structure with one lag
/// - one_motion: 1: `one_motion` uses this structure
/// - drifting: 1: `drifting` uses this structure
/// - drifting_score: log score of `drifting`; NaN: not computed
/// - modes_score: log score of a bank of modes; NaN: not computed
/// - one_motion_score: log score of `one_motion`; NaN: not computed
template <class Io, class F>
void exchange_found_structure(Io& io, F& found, Eigen::Index inputs) {
  io.attribute("state_lags", found.state_lags, rule::lags);
  io.attribute("input_lags", found.input_lags, rule::lags);
  exchange_delays(io, found.input_delay, inputs);
  io.attribute("samples", found.samples);
  io.attribute("parts", found.parts);
  io.attribute("by_runs", found.by_runs);
  io.attribute("structures", found.structures);
  io.attribute("noise_lags", found.noise_lags);
  io.attribute("differences", found.differences);
  io.attribute("remark", found.remark);
  io.table("scores", found.scores, column("state_lags", &StructureScore::state_lags).obeying(rule::lags),
           column("input_lags", &StructureScore::input_lags).obeying(rule::lags),
           column("input_delay", &StructureScore::input_delay).obeying(rule::delay),
           column("log_score", &StructureScore::log_score, "nat"), column("loss", &StructureScore::loss, "nat"),
           column("loss_standard_error", &StructureScore::loss_standard_error, "nat"),
           column("rmse", &StructureScore::rmse), column("chosen", &StructureScore::chosen),
           column("linear", &StructureScore::linear), column("one_motion", &StructureScore::one_motion),
           column("drifting", &StructureScore::drifting),
           column("drifting_score", &StructureScore::drifting_score, "nat"),
           column("modes_score", &StructureScore::modes_score, "nat"),
           column("one_motion_score", &StructureScore::one_motion_score, "nat"),
           column("noise_lags", &StructureScore::noise_lags), column("differences", &StructureScore::differences));
}

}  // namespace modebank::layout
