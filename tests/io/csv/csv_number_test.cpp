// Numbers in text files: decimal marks, thousands separators, words for missing values.
#include "io/csv/csv_number.hpp"

#include <gtest/gtest.h>

#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

const std::vector<std::string> usual{"NA", "N/A", "null", "-"};

void expect(bool decimal_comma, const char* field, double value) {
  const ParsedNumber number = CsvNumbers(decimal_comma, usual).parse(field);
  EXPECT_EQ(number.status, NumberStatus::ok) << field;
  EXPECT_EQ(number.value, value) << field;
}
void expect(bool decimal_comma, const char* field, NumberStatus status) {
  EXPECT_EQ(CsvNumbers(decimal_comma, usual).parse(field).status, status) << field;
}

TEST(CsvNumbers, WithADecimalCommaPointsMarkThousands) {
  expect(true, "2.499", 2499.0);
  expect(true, "2.499,45", 2499.45);
  expect(true, "-1.234.567,5", -1234567.5);
  expect(true, "+12.000", 12000.0);
  expect(true, "1,5", 1.5);
  expect(true, "1,234", 1.234);
  expect(true, "-0,25e3", -250.0);
  expect(true, "1.500,5e2", 150050.0);
  expect(true, "17", 17.0);
  expect(true, "2 499,45", 2499.45);
  expect(true, "2\u00A0499,45", 2499.45);
  expect(true, "2\u202F499", 2499.0);
  for (const char* field :
       {"2.49", "0.125", "12.5", "2.499.4", "1.2345", "0001.234", "1234.567", "1,5,6", "1.5,5", ".499", "2.499e3"})
    expect(true, field, NumberStatus::text);
}

TEST(CsvNumbers, WithADecimalPointACommaMarksThousandsOnlyWhereThatIsClear) {
  expect(false, "2,499.45", 2499.45);
  expect(false, "1,234,567", 1234567.0);
  expect(false, "-1,234.", -1234.0);
  expect(false, "2'499.5", 2499.5);
  expect(false, "2 499", 2499.0);
  expect(false, "2.499", 2.499);
  for (const char* field : {"2,499", "1,5", "2,49.5", "0,125.5", "1,2345.6", "12 34", "2,499e3"})
    expect(false, field, NumberStatus::text);
}

TEST(CsvNumbers, TruthValuesAreNumbers) {
  for (const bool comma : {false, true}) {
    for (const char* field : {"true", "True", "TRUE"}) expect(comma, field, 1.0);
    for (const char* field : {"false", "False", " FALSE "}) expect(comma, field, 0.0);
    expect(comma, "tRuE", NumberStatus::text);
  }
}

TEST(CsvNumbers, WordsStandForMissingValues) {
  for (const bool comma : {false, true})
    for (const char* field : {"", " ", "NaN", "nan", "inf", "NA", "na", "N/A", "null", "NULL", " - "})
      expect(comma, field, NumberStatus::missing);
  expect(false, "--", NumberStatus::text);
  expect(false, "none", NumberStatus::text);
  const CsvNumbers own(false, {"-999", "bad"});
  EXPECT_EQ(own.parse("-999.0").status, NumberStatus::missing) << "a number by its value";
  EXPECT_EQ(own.parse("-9.99e2").status, NumberStatus::missing);
  EXPECT_EQ(own.parse("-998").status, NumberStatus::ok);
  EXPECT_EQ(own.parse("Bad").status, NumberStatus::missing);
  EXPECT_EQ(own.parse("NA").status, NumberStatus::text) << "the list is the user's";
  EXPECT_EQ(own.parse("").status, NumberStatus::missing);
  EXPECT_EQ(*own.missing_word("-999.0"), "-999");
  EXPECT_EQ(CsvNumbers(true, {"-999,5"}).missing_word("1"), nullptr);
}

TEST(CsvNumbers, ShowTheirMark) {
  for (const char* field : {"0,0", "40,00", "2.499,50", "1.234.567", "0,125", "1,5e3"})
    EXPECT_EQ(mark_shown(field), MarkShown::comma) << field;
  for (const char* field : {"0.0", "40.00", "2,499.50", "1,234,567", "0.125", "1.5e3", ".5"})
    EXPECT_EQ(mark_shown(field), MarkShown::point) << field;
  EXPECT_EQ(mark_shown("2.499"), MarkShown::either_point);
  EXPECT_EQ(mark_shown("2,499"), MarkShown::either_comma);
  for (const char* field : {"17", "", "flow", "a,b", "v1.2.3", "10:00:00,5"})
    EXPECT_EQ(mark_shown(field), MarkShown::none) << field;
}

}  // namespace
}  // namespace modebank
