#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/stamp.hpp"

namespace modebank {

/// A format of times as text. It uses strptime's letters (C locale), and %f for the fraction of a second.
/// In a value, the fraction with its point or comma may be absent, and so may a zone (%z) at the end. Without a zone
/// the time is UTC. Without a date the stamp counts from midnight, and a leading %H may exceed 23.
class StampPattern {
 public:
  /// Throws std::invalid_argument for a letter that strptime lacks, and for a pattern without a time.
  explicit StampPattern(std::string text);

  /// Seconds since 1970; for a pattern without a date, since midnight. Blanks around the value are allowed. Nullopt if
  /// the value does not fit the pattern.
  std::optional<Stamp> read(std::string_view value) const;

  const std::string& text() const { return text_; }
  bool has_date() const { return has_date_; }

 private:
  std::string text_;
  std::string head_,
      tail_;               ///< parts before and after the fraction; if the point is required, it is the end of `head_`
  bool fraction_ = false;  ///< whether the pattern has a fraction
  bool may_lack_fraction_ = false, has_date_ = false;
};

/// Formats of loggers, spreadsheets and robots, in the order in which they are tried.
const std::vector<StampPattern>& known_stamp_patterns();

/// Whether one of these formats fits the text.
bool is_known_time(std::string_view value);

}  // namespace modebank
