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

/// Treatment of a missing value (empty, NaN or infinite): refuse the data, split the run there, or keep the sample. A
/// kept sample with a missing state is only predicted; a missing input takes its last known value.
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
  std::string inputs;  ///< one file per run; the part matched by * names the run (io/import/file_patterns.hpp)
  std::string states;  ///< the same for states; empty: states are columns of the inputs file
  std::vector<std::string> state;  ///< column names
  std::vector<std::string> input;
  std::vector<std::string> truth;       ///< true states; as many as states, or none
  std::vector<std::string> derive;      ///< computed channels, each "NAME [unit] = EXPRESSION" (io/import/derived.hpp)
  std::string where;                    ///< a gap where this expression is false or missing; empty: none
  std::vector<std::string> state_unit;  ///< one per state, one for all, or none
  std::vector<std::string> input_unit;
  /// Column of sample weights, at least 0 (Trajectory::weight); looked for in the states file first, as truth is.
  /// Empty: none.
  std::string weight;
  /// Column of a known class such as the ground, text or whole numbers. A missing value repeats the one before. Empty:
  /// none.
  std::string label;
  /// Column of times (one; or seconds and nanoseconds, or date and time of day). In a recording "time" means header
  /// stamps, or receive times for messages without them; receive_time always means receive times. Empty: row k of a
  /// file is at k / rate_hz.
  std::vector<std::string> time{"time"};
  TimeUnit time_unit = TimeUnit::automatic;
  std::string time_format;  ///< format of times as text (io/table/stamp_pattern.hpp); empty: found
  Join join = Join::time;
  /// Column whose value separates runs inside one file. It names the run, after "<matched part>_" where inputs has a *.
  /// Join::time needs it in both files; otherwise the states file is searched first, as for `time`.
  std::string run;
  double rate_hz = 0.0;         ///< 0: the inputs file's own times; else resampled (states linear, inputs held)
  double lag_s = 0.0;           ///< inputs act this much later: at time t the input is u(t - lag_s), held
  bool lag_auto = false;        ///< lag_s is estimated on the training runs (ident/lag/choice.hpp)
  double lag_range_s = 2.5;     ///< largest lag, of either sign, that the estimate searches
  std::vector<double> quantum;  ///< rounding step of the states, one each or one for all [state unit]; empty: none
  bool quantum_auto = false;    ///< found in the training runs (io/import/quanta.hpp)
  FormatOptions format;         ///< formats that files do not state themselves
  Missing missing = Missing::error;
  Disorder disorder = Disorder::error;
  SplitOptions split;
  std::vector<std::string> train;  ///< run names; empty: all not in test, or positions 0, 2, 4, ... in name order
  std::vector<std::string> test;   ///< run names; empty: all that are not train
};

}  // namespace modebank
