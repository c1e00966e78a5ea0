#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/number.hpp"

namespace modebank {

/// How a text file writes numbers: its decimal mark, with marks of thousands between groups of three digits, and the
/// words that stand for a missing value (data.na).
///
/// With a decimal comma, points, blanks and apostrophes are marks of thousands: 2.499 is 2499, and 2.49 an error.
/// With a decimal point, commas, blanks and apostrophes are, but a single comma is read so only beside a point: 2,499.5
/// is 2499.5, and 2,499 an error, because others write 2.499 so.
class CsvNumbers {
 public:
  /// `missing`: words, compared without regard to case; numbers among them (-999) are compared by value.
  CsvNumbers(bool decimal_comma, const std::vector<std::string>& missing);

  ParsedNumber parse(std::string_view field) const;

  /// The field with a decimal point and without marks of thousands, as other readers of numbers and of times take it;
  /// nothing where its marks are others.
  std::optional<std::string> with_point(std::string_view field) const;

  /// The word of data.na that the field is; null: none.
  const std::string* missing_word(std::string_view field) const;

  bool decimal_comma() const { return decimal_comma_; }

 private:
  bool decimal_comma_;
  std::vector<std::string> words_;
  std::vector<double> values_;  // of the words that are numbers
};

/// The field with each comma replaced by a point.
std::string commas_as_points(std::string_view field);

/// The decimal mark that a field shows: a comma in 1,5 and 2.499,50, a point in 1.5 and 2,499.50; 2.499
/// and 2,499 show neither.
enum class MarkShown { none, point, comma, either_point, either_comma };
MarkShown mark_shown(std::string_view field);

}  // namespace modebank
