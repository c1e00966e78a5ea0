#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A stream as in its file.
struct FileStream {
  Stream stream;                    ///< times may repeat or go backwards until put_in_order
  std::vector<std::uint64_t> line;  ///< line in the file, per sample
  std::string file, time_column;
  std::int64_t origin_ns = 0;        ///< origin of the times, which are seconds
  std::vector<LineRange> unwritten;  ///< lines without written times

  /// Time of a sample as in the file.
  std::string time_text(Index k) const;
};

/// With Disorder::sort, sorts by time and keeps the first of samples with equal times. With Disorder::error, throws
/// DataError with file and line if time repeats or goes backwards.
void put_in_order(FileStream& source, Disorder disorder);

/// Recorded labels of a run.
struct LabelStream {
  Eigen::VectorXd time_s;
  std::vector<std::string> text;  ///< empty: no labels
};

/// The streams of one run, before they are joined. Under Join::row, or if states and inputs are columns of one file,
/// both streams have the same times.
struct RunStreams {
  std::string run;
  Role role = Role::train;
  FileStream states, inputs;
  /// A column that is sampled together with the states, or with the inputs.
  struct Companion {
    bool with_states = true;
    Eigen::VectorXd values;
  };
  std::vector<Companion> truth;
  std::vector<Companion> weight;  ///< at most one column
  std::vector<Companion> where;   ///< at most one column, whose values are 1 if data.where is true, else 0

  LabelStream label;  ///< empty without labels

  /// All columns that are sampled with states or inputs.
  std::vector<std::vector<Companion>*> companions() { return {&truth, &weight, &where}; }
};

/// Keeps the samples at these positions.
void take(FileStream& source, const std::vector<Index>& positions);

/// For each sample of the joined run, whether data.where is true: at the states' samples on both sides, or at the
/// inputs in force. Empty without data.where.
std::vector<bool> kept_samples(const RunStreams& run, const Trajectory& joined);

/// Puts both streams and their companions in order.
void put_in_order(RunStreams& run, Disorder disorder);

struct LogSampling;

/// The run in the form that identification uses, sampled by `sampling`: states interpolated or averaged, inputs held or
/// averaged. Inputs are delayed by the constant options.lag_s. With options.lag_auto they are delayed by `clock`,
/// evaluated in the middle of each transition (hold_mid_transition). Samples whose delayed input is unknown are
/// dropped. Throws DataError if fewer than two remain.
Trajectory join_run(const RunStreams& run, const DataOptions& options, const LogSampling& sampling,
                    const InputClock& clock);

}  // namespace modebank
