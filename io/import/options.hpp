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

/// What to do about a missing value (empty, NaN or infinite): refuse the data, split the run there, or keep the sample:
/// a missing state is a step of prediction only, a missing input the last known one.
enum class Missing { error, gap, predict };

template <>
struct EnumNames<Missing> {
  static constexpr Names<3> values{"error", "gap", "predict"};
};

/// What to do about times that go backwards or repeat: refuse the data, or sort the rows by time and keep the first of
/// those that share one.
enum class Disorder { error, sort };

template <>
struct EnumNames<Disorder> {
  static constexpr Names<2> values{"error", "sort"};
};

/// How each run becomes runs of its own that train and test in turn (io/import/split.hpp).
enum class SplitKind { none, blocks, last };

struct SplitOptions {
  SplitKind kind = SplitKind::none;
  int blocks = 0;             ///< of kind blocks
  double last_percent = 0.0;  ///< of kind last
  /// Dropped between blocks: a window and the lags of what is fitted there. Set by who knows them; 0 without a split.
  std::ptrdiff_t gap_samples = 0;
};

/// Of data.rate_hz.
inline constexpr double highest_rate_hz = 1e6;

/// What to read and how: the [data] section.
struct DataOptions {
  std::string root;    ///< absolute prefix of relative patterns
  std::string inputs;  ///< one file per run; the part matched by * names the run (io/import/file_patterns.hpp)
  std::string states;  ///< the same for states; empty: states are columns of the inputs file
  std::vector<std::string> state;  ///< column names
  std::vector<std::string> input;
  std::vector<std::string> truth;       ///< true states; as many as states, or none
  std::vector<std::string> derive;      ///< computed channels, each "NAME [unit] = EXPRESSION" (io/import/derived.hpp)
  std::string where;                    ///< a stretch where this expression is false or missing is a gap; empty: none
  std::vector<std::string> state_unit;  ///< one per state, one for all, or none
  std::vector<std::string> input_unit;
  /// Column of sample weights, at least 0 (Trajectory::weight); looked up as truth is: in the states file first. Empty:
  /// none.
  std::string weight;
  /// Column of what is known of the ground or the like, text or whole numbers; the last one holds. Empty: none.
  std::string label;
  /// Column of times (one; or seconds and nanoseconds, or date and time of day). In a recording "time" means its
  /// messages' header stamps, or where they have none when they were received; receive_time the latter. Empty: row k of
  /// a file is k / rate_hz.
  std::vector<std::string> time{"time"};
  TimeUnit time_unit = TimeUnit::automatic;
  std::string time_format;  ///< of times as text (io/table/stamp_pattern.hpp); empty: found
  Join join = Join::time;
  /// Column whose value separates runs inside one file: the run is named by it, after "<matched part>_" where inputs
  /// has a *. Join::time needs it in both files; else it is looked up in the states file first, as `time` is.
  std::string run;
  double rate_hz = 0.0;         ///< 0: the inputs file's own times; else resampled (states linear, inputs held)
  double lag_s = 0.0;           ///< inputs act this much later: at time t the input is u(t - lag_s), held
  bool lag_auto = false;        ///< lag_s is estimated on the training runs (ident/lag/choice.hpp)
  double lag_range_s = 2.5;     ///< lags that the estimate searches, either way
  std::vector<double> quantum;  ///< what states are multiples of, one each or one for all [state unit]; empty: none
  bool quantum_auto = false;    ///< found in the training runs (io/import/quanta.hpp)
  FormatOptions format;         ///< what files say too little of themselves
  Missing missing = Missing::error;
  Disorder disorder = Disorder::error;
  SplitOptions split;
  std::vector<std::string> train;  ///< run names; empty: all not in test, or positions 0, 2, 4, ... in name order
  std::vector<std::string> test;   ///< run names; empty: all that are not train
};

}  // namespace modebank
