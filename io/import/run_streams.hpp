#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A stream as it stands in its file.
struct FileStream {
  Stream stream;                    ///< times may repeat or go backwards until put_in_order
  std::vector<std::uint64_t> line;  ///< per sample, of the file
  std::string file, time_column;
  std::int64_t origin_ns = 0;        ///< of the times, which are seconds since then
  std::vector<LineRange> unwritten;  ///< lines whose times were never written

  /// Time of a sample as the file has it.
  std::string time_text(Index k) const;
};

/// Sorts by time and keeps the first of the samples that share one (Disorder::sort), or throws DataError, naming file
/// and line, where time repeats or goes backwards (Disorder::error).
void put_in_order(FileStream& source, Disorder disorder);

/// What is known of a run from outside, as recorded.
struct LabelStream {
  Eigen::VectorXd time_s;
  std::vector<std::string> text;  ///< empty: not known
};

/// The streams of one run, not yet joined. Under Join::row, and where states and inputs are columns of one file, both
/// have the same times.
struct RunStreams {
  std::string run;
  Role role = Role::train;
  FileStream states, inputs;
  /// A column that is sampled with the states or with the inputs.
  struct Companion {
    bool with_states = true;
    Eigen::VectorXd values;
  };
  std::vector<Companion> truth;
  std::vector<Companion> weight;  ///< one, or none
  std::vector<Companion> where;   ///< one, or none: 1 where data.where is true, else 0

  LabelStream label;  ///< empty without one

  /// All that is sampled with states or inputs.
  std::vector<std::vector<Companion>*> companions() { return {&truth, &weight, &where}; }
};

/// Keeps the samples at these positions.
void take(FileStream& source, const std::vector<Index>& positions);

/// Per sample of the joined run whether data.where is true there: of the states' samples on both sides, or of the
/// inputs in force; empty without it.
std::vector<bool> kept_samples(const RunStreams& run, const Trajectory& joined);

/// Both streams, and what is sampled with them.
void put_in_order(RunStreams& run, Disorder disorder);

struct LogSampling;

/// The run as identification sees it, sampled as `sampling` says: states interpolated or averaged, inputs held or
/// averaged, and delayed by the constant options.lag_s, or by
/// `clock` when options.lag_auto (taken in the middle of each transition, see hold_mid_transition). Samples whose
/// delayed input is not known are dropped. Throws DataError when fewer than two are left.
Trajectory join_run(const RunStreams& run, const DataOptions& options, const LogSampling& sampling,
                    const InputClock& clock);

}  // namespace modebank
