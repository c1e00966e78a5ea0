#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/table/table_reader.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// How states file and inputs file are joined: by time (states interpolated linearly) or row by row.
enum class Join { time, row };

template <>
struct EnumNames<Join> {
  static constexpr Names<2> values{"time", "row"};
};

/// Treatment of a missing value (empty, NaN or infinite). The data are refused, the run is split there, or the sample
/// is kept. In a kept sample a missing state is only predicted, and a missing input takes its last known value.
enum class Missing { error, gap, predict };

template <>
struct EnumNames<Missing> {
  static constexpr Names<3> values{"error", "gap", "predict"};
};

/// Treatment of times that go backwards or repeat. The data are refused, or rows are sorted by time. Of rows with equal
/// times only the first is kept.
enum class Disorder { error, sort };

template <>
struct EnumNames<Disorder> {
  static constexpr Names<2> values{"error", "sort"};
};

/// How each run is split into training parts and test parts (io/import/split.hpp).
enum class SplitKind { none, blocks, last };

struct SplitOptions {
  SplitKind kind = SplitKind::none;
  int blocks = 0;             ///< used if the kind is `blocks`
  double last_percent = 0.0;  ///< used if the kind is `last`
  /// Number of samples that are dropped between blocks: a window plus the lags of the model. The caller sets it; 0
  /// without a split.
  std::ptrdiff_t gap_samples = 0;
};

/// Largest data.rate_hz.
inline constexpr double highest_rate_hz = 1e6;

/// Options of the [data] section.
struct DataOptions {
  std::string root;    ///< absolute path from which relative patterns start
  std::string inputs;  ///< one file per run; the text that `*` matches is the run's name (io/import/file_patterns.hpp)
  std::string states;  ///< like `inputs`, for states; empty: states are columns of the inputs files
  std::vector<std::string> state;  ///< column names
  std::vector<std::string> input;
  std::vector<std::string> truth;       ///< true states: one for each state, or none
  std::vector<std::string> derive;      ///< computed channels, each "NAME [unit] = EXPRESSION" (io/import/derived.hpp)
  std::string where;                    ///< a gap is where this expression is false or missing; empty: no condition
  std::vector<std::string> state_unit;  ///< one per state, one for all states, or none
  std::vector<std::string> input_unit;
  /// Column of a known class such as the ground, as text or whole numbers; empty: no class. A missing value means the
  /// previous value.
  std::string label;
  /// Column of times. It may be two columns: seconds and nanoseconds, or date and time of day.
  /// In a recording "time" means header stamps, or receive times for messages without header stamps. receive_time
  /// always means receive times. Empty: the time of row k in a file is k / rate_hz.
  std::vector<std::string> time{"time"};
  TimeUnit time_unit = TimeUnit::automatic;
  std::string time_format;  ///< format of times that are text (io/table/stamp_pattern.hpp); empty: found from the data
  Join join = Join::time;
  /// Column whose value tells the runs in one file apart. The value is the run's name. If `inputs` has a `*`, the
  /// matched text and "_" come before it. Join::time needs the column in both files. Otherwise the states file is
  /// searched first, as for `time`.
  std::string run;
  double rate_hz = 0.0;         ///< 0: the inputs file's own times; > 0: resampled (states linear, inputs held)
  double lag_s = 0.0;           ///< delay of the inputs' effect: at time t the input is u(t - lag_s)
  bool lag_auto = false;        ///< true: lag_s is estimated on the training runs (ident/lag/choice.hpp)
  std::vector<double> quantum;  ///< rounding step of the states [state unit]: one per state, or one for all; empty:
                                ///< none
  bool quantum_auto = false;    ///< true: the step is found in the training runs (io/import/quanta.hpp)
  FormatOptions format;         ///< formats that the files themselves do not state
  Missing missing = Missing::error;
  Disorder disorder = Disorder::error;
  SplitOptions split;
  std::vector<std::string>
      train;  ///< run names; empty: all runs that are not in `test`, or positions 0, 2, 4, ... in name order
  std::vector<std::string> test;  ///< run names; empty: all runs that are not used for training
};

}  // namespace modebank
