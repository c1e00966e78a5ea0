#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/number.hpp"

namespace modebank {

/// Format of the numbers in a text file: the decimal mark, the thousands separators between groups of three digits, and
/// the words for missing values (data.na).
///
/// - With a decimal comma, points, blanks and apostrophes separate thousands. 2.499 is 2499, and 2.49 is an error.
/// - With a decimal point, commas, blanks and apostrophes separate thousands. A number with a single comma must also
/// have a point. 2,499.5 is 2499.5. 2,499 is an error, because it may also mean 2.499.
class CsvNumbers {
 public:
  /// `missing`: words for missing values, compared without case. Words that are numbers (-999) are compared by value.
  CsvNumbers(bool decimal_comma, const std::vector<std::string>& missing);

  ParsedNumber parse(std::string_view field) const;

  /// The field with a decimal point and without thousands separators, for other parsers of numbers and times. Nullopt
  /// if the field contains unsuitable marks.
  std::optional<std::string> with_point(std::string_view field) const;

  /// The word of data.na that equals the field. Null if no word does.
  const std::string* missing_word(std::string_view field) const;

  bool decimal_comma() const { return decimal_comma_; }

 private:
  bool decimal_comma_;
  std::vector<std::string> words_;
  std::vector<double> values_;  // those words that are numbers
};

/// The field with each comma replaced by a point.
std::string commas_as_points(std::string_view field);

/// The decimal mark of a field. A comma in 1,5 and 2.499,50; a point in 1.5 and 2,499.50. Ambiguous in 2.499 and 2,499.
enum class MarkShown { none, point, comma, either_point, either_comma };
MarkShown mark_shown(std::string_view field);

}  // namespace modebank
