#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A stream as it is in its file.
struct FileStream {
  Stream stream;                    ///< may repeat or go backwards until put_in_order is called
  std::vector<std::uint64_t> line;  ///< line of each sample in the file
  std::string file, time_column;
  std::int64_t origin_ns = 0;        ///< times are in seconds from this origin
  std::vector<LineRange> unwritten;  ///< the lines that contain no time

  /// Time of a sample as it is written in the file.
  std::string time_text(Index k) const;
};

/// With Disorder::sort, sorts the samples by time. Of samples with equal times it keeps the first. With
/// Disorder::error, throws DataError with file and line if a time repeats or goes backwards.
void put_in_order(FileStream& source, Disorder disorder);

/// Recorded labels of a run.
struct LabelStream {
  Eigen::VectorXd time_s;
  std::vector<std::string> text;  ///< empty if there are no labels
};

/// The streams of one run, before they are joined. Both streams have the same times under Join::row, and also if states
/// and inputs are columns of one file.
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
  std::vector<Companion> where;  ///< at most one column; its values are 1 where data.where is true, otherwise 0

  LabelStream label;  ///< empty if there are no labels

  /// All columns that are sampled together with states or inputs.
  std::vector<std::vector<Companion>*> companions() { return {&truth, &where}; }
};

/// Keeps the samples at these positions.
void take(FileStream& source, const std::vector<Index>& positions);

/// For each sample of the joined run, whether data.where is true. For states, it must be true in the samples on both
/// sides; for inputs, in the input that is held. Empty without data.where.
std::vector<bool> kept_samples(const RunStreams& run, const Trajectory& joined);

/// Sorts both streams and their companions.
void put_in_order(RunStreams& run, Disorder disorder);

struct LogSampling;

/// The run in the form that identification uses, sampled as `sampling` states. States are interpolated or averaged;
/// inputs are held or averaged. Throws DataError if fewer than two samples remain.
/// Inputs are delayed by the constant options.lag_s. With options.lag_auto they are delayed by
/// `estimated_lag_s`, evaluated in the middle of each transition (hold_mid_transition). Samples whose delayed input is
/// unknown are dropped.
Trajectory join_run(const RunStreams& run, const DataOptions& options, const LogSampling& sampling,
                    double estimated_lag_s);

}  // namespace modebank
