#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "filter/step/bank_filter.hpp"
#include "ident/base/characters.hpp"
#include "ident/base/printable.hpp"
#include "io/archive/load_input_range.hpp"
#include "io/files/standard_error.hpp"

namespace modebank::app {

/// Reasons not to trust an output line of `track`.
struct ValidityFlags {
  bool warming_up = false;  ///< the filter has not started, or has made fewer than ten predictions since the start
  bool input_beyond_training = false;  ///< an input is outside the range of the training runs
  bool unlike_any_mode = false;        ///< no mode predicts the measurement well
  bool stamp_late = false;             ///< at least one and a half model steps passed since the sample before
};

/// Sets the flags for a stream of samples.
class ValidityJudge {
 public:
  /// `lags`: samples before the filter starts; `dt_s`: period of a model step.
  ValidityJudge(InputRange trained, Eigen::Index lags, double dt_s)
      : trained_(std::move(trained)), lags_(lags), dt_s_(dt_s) {}

  /// Call this when the filter starts anew.
  void restart() { samples_ = 0; }
  /// Judges the next sample. `started`: whether the filter has started.
  ValidityFlags judge(double time_s, const Eigen::VectorXd& input, const FilterEstimate& estimate, bool started);

 private:
  InputRange trained_;
  Eigen::Index lags_;
  double dt_s_;
  Eigen::Index samples_ = 0;  ///< number of samples since the filter's restart
  double last_s_ = 0.0;
};

/// Format of the output lines, and their optional fields.
struct EstimateLines {
  bool json = false;  ///< NDJSON instead of CSV with a header
  bool run = false;   ///< lines contain the name of the run
};

/// Writes estimates as lines of CSV or NDJSON. An unknown value is empty in CSV and null in NDJSON.
class EstimateWriter {
 public:
  EstimateWriter(std::vector<std::string> states, Eigen::Index modes, const EstimateLines& lines);

  /// Appends the CSV header. NDJSON has no header.
  void header(fmt::memory_buffer& out) const;
  void line(const std::string& run, double time_s, const FilterEstimate& estimate, const LiveVerdict& verdict,
            const ValidityFlags& flags, fmt::memory_buffer& out) const;

 private:
  std::vector<std::string> states_;
  Eigen::Index modes_;
  EstimateLines lines_;
};

/// Messages of a live filter on standard error. Printing never blocks and never fails. A message that standard error
/// does not accept is dropped. The next message states how many were dropped.
class LiveMessages {
 public:
  void say(std::string_view text) {
    if (dropped_ > 0 && say_now(fmt::format("modebank: {} messages before this one were dropped\n", dropped_)))
      dropped_ = 0;
    if (dropped_ > 0 || !say_now(fmt::format("modebank: {}\n", printable(text)))) ++dropped_;
  }
  /// Prints only the first message of a kind: they differ only in numbers and quoted words.
  void say_once(const std::string& place, const std::string& text) {
    Repeats& repeats = repeats_[kind_of(text)];
    if (repeats.count++ == 0) {
      repeats.first = place;
      say(fmt::format("{}: {}", place, text));
    }
    repeats.last = place;
  }
  /// Prints remarks on the stream, each only once. Repetitions are not counted.
  void say_note(const std::string& place, const std::string& text) {
    if (notes_.insert(text).second) say(fmt::format("{}: {}", place, text));
  }
  /// Prints how often each message of say_once was repeated.
  void say_repeats() {
    for (const auto& [kind, repeats] : repeats_)
      if (repeats.count > 1)
        say(fmt::format("{}: this message was repeated {} time{}, last at {}", repeats.first, repeats.count - 1,
                        repeats.count == 2 ? "" : "s", repeats.last));
    repeats_.clear();
  }

 private:
  struct Repeats {
    std::size_t count = 0;
    std::string first, last;  ///< positions of the first and the last message in the input
  };
  std::size_t dropped_ = 0;
  std::map<std::string, Repeats> repeats_;
  std::set<std::string> notes_;

  static std::string kind_of(const std::string& text) {
    std::string kind;
    bool quoted = false;
    for (const char c : text) {
      if (c == '"') quoted = !quoted;
      if (!quoted && !is_digit(c) && c != '.' && c != '-' && c != '+') kind += c;
    }
    return kind;
  }
};

}  // namespace modebank::app
