#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/stamp.hpp"

namespace modebank {

/// One way to write a time as text, in strptime's letters (C locale) and %f for the fraction of a second. A fraction
/// behind a point or comma and a zone (%z) at the end may be missing in a value. Without a zone UTC is meant, without a
/// date the stamp counts from midnight, and hours of %H at the beginning may go on past 23.
class StampPattern {
 public:
  /// Throws std::invalid_argument for a letter that strptime lacks, and for a pattern without any time.
  explicit StampPattern(std::string text);

  /// Seconds since 1970, or since midnight without a date. Blanks around are tolerated. Empty: does not fit.
  std::optional<Stamp> read(std::string_view value) const;

  const std::string& text() const { return text_; }
  bool has_date() const { return has_date_; }

 private:
  std::string text_;
  std::string head_, tail_;  ///< before and behind the fraction, which has its point in `head_` if it must be there
  bool fraction_ = false;    ///< whether there is one
  bool may_lack_fraction_ = false, has_date_ = false;
};

/// The forms that loggers, spreadsheets and robots write, in the order in which they are tried.
const std::vector<StampPattern>& known_stamp_patterns();

/// Whether any of them fits.
bool is_known_time(std::string_view value);

}  // namespace modebank
