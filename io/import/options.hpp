#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/table/table_reader.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// How the states file joins the inputs file: on time (states interpolated linearly) or row by row.
enum class Join { time, row };

template <>
struct EnumNames<Join> {
  static constexpr Names<2> values{"time", "row"};
};

/// Treatment of a missing value (empty, NaN or infinite): refuse the data, split the run there, or keep the sample. In
/// a kept sample a missing state is only predicted, and a missing input takes its last known value.
enum class Missing { error, gap, predict };

template <>
struct EnumNames<Missing> {
  static constexpr Names<3> values{"error", "gap", "predict"};
};

/// Treatment of times that go backwards or repeat: refuse the data, or sort the rows by time and keep the first of
/// those with equal times.
enum class Disorder { error, sort };

template <>
struct EnumNames<Disorder> {
  static constexpr Names<2> values{"error", "sort"};
};

/// How each run is split into parts that train and parts that test (io/import/split.hpp).
enum class SplitKind { none, blocks, last };

struct SplitOptions {
  SplitKind kind = SplitKind::none;
  int blocks = 0;             ///< with kind blocks
  double last_percent = 0.0;  ///< with kind last
  /// Samples dropped between blocks: a window and the lags of the model. The caller sets it; 0 without a split.
  std::ptrdiff_t gap_samples = 0;
};

/// Largest data.rate_hz.
inline constexpr double highest_rate_hz = 1e6;

/// Options of the [data] section.
struct DataOptions {
  std::string root;    ///< absolute prefix of relative patterns
  std::string inputs;  ///< one file per run; the part that * matches names the run (io/import/file_patterns.hpp)
  std::string states;  ///< the same for states; empty: states are columns of the inputs files
  std::vector<std::string> state;  ///< column names
  std::vector<std::string> input;
  std::vector<std::string> truth;   ///< true states; as many as states, or none
  std::vector<std::string> derive;  ///< computed channels, each "NAME [unit] = EXPRESSION" (io/import/derived.hpp)
  std::string where;                ///< where this expression is false or missing, there is a gap; empty: no condition
  std::vector<std::string> state_unit;  ///< one per state, one for all, or none
  std::vector<std::string> input_unit;
  /// Column of sample weights, at least 0 (Trajectory::weight); empty: no weights. It is searched in the states file
  /// first, as truth is.
  std::string weight;
  /// Column of a known class such as the ground, as text or whole numbers; empty: none. A missing value repeats the one
  /// before.
  std::string label;
  /// Column of times: one column; or two, for seconds and nanoseconds, or date and time of day. In a recording "time"
  /// means header stamps, or receive times for messages without these; receive_time always means receive times. Empty:
  /// row k of a file is at k / rate_hz.
  std::vector<std::string> time{"time"};
  TimeUnit time_unit = TimeUnit::automatic;
  std::string time_format;  ///< format of times as text (io/table/stamp_pattern.hpp); empty: found
  Join join = Join::time;
  /// Column whose value separates the runs inside one file. The value names the run, after "<matched part>_" if inputs
  /// has a *. Join::time needs the column in both files. Otherwise the states file is searched first, as for `time`.
  std::string run;
  double rate_hz = 0.0;         ///< 0: the inputs file's own times; else resampled (states linear, inputs held)
  double lag_s = 0.0;           ///< inputs act this much later: at time t the input is u(t - lag_s)
  bool lag_auto = false;        ///< lag_s is estimated on the training runs (ident/lag/choice.hpp)
  double lag_range_s = 2.5;     ///< largest lag, of either sign, that the estimate searches
  std::vector<double> quantum;  ///< rounding step of the states, one for each or one for all [state unit]; empty: none
  bool quantum_auto = false;    ///< the step is found in the training runs (io/import/quanta.hpp)
  FormatOptions format;         ///< formats that files do not state themselves
  Missing missing = Missing::error;
  Disorder disorder = Disorder::error;
  SplitOptions split;
  std::vector<std::string>
      train;  ///< run names; empty: all runs that are not in test, or positions 0, 2, 4, ... in name order
  std::vector<std::string> test;  ///< run names; empty: all runs that do not train
};

}  // namespace modebank
