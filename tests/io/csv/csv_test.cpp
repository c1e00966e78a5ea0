#include "io/csv/csv.hpp"

#include "io/csv/csv_head.hpp"
#include "io/table/number.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Table parse(std::string_view content, const TableRequest& request = {0, {"a", "b"}}) {
  return parse_csv("f.csv", content, request);
}

std::string data_error(std::string_view content, const TableRequest& request = {0, {"a", "b"}}) {
  return message_of<DataError>([&] { parse(content, request); });
}

TEST(Csv, ReadsNamedColumnsInAnyOrder) {
  const Table table = parse("x,b,c,a\n1,2,3,4\n5,6,7,8\n");
  ASSERT_EQ(table.numbers.size(), 2);
  EXPECT_THAT(table.numbers[0], ElementsAre(4, 8));
  EXPECT_THAT(table.numbers[1], ElementsAre(2, 6));
  EXPECT_THAT(table.line, ElementsAre(2, 3));
  EXPECT_THAT(table.texts, IsEmpty());
}

TEST(Csv, OtherColumnsMayHoldAnything) {
  const Table table = parse("a,note,b\n1,\"x, \"\"y\"\"\nz, w\",2\n3,nan,4\n5,,6\n");
  EXPECT_THAT(table.numbers[0], ElementsAre(1, 3, 5));
  EXPECT_THAT(table.numbers[1], ElementsAre(2, 4, 6));
  EXPECT_THAT(table.line, ElementsAre(2, 4, 5)) << "the first row spans two lines";
}

TEST(Csv, ReadsTextAndNumbersOfOneColumn) {
  const Table table = parse("a,b\n 07 ,1\n\"8\",2\n", {0, {"a"}, {"a"}});
  EXPECT_THAT(table.numbers[0], ElementsAre(7, 8));
  EXPECT_THAT(table.texts.at(0), ElementsAre("07", "8"));
}

TEST(Csv, KeepsQuotedTextAsItIs) {
  EXPECT_THAT(parse("a,t\n1,\"x, \"\"y\"\"\"\n", {0, {"a"}, {"t"}}).texts.at(0), ElementsAre("x, \"y\""));
}

TEST(Csv, AcceptsMarkCrlfBlanksAndQuotedNames) {
  const Table table = parse("\xEF\xBB\xBF\"a\" , \"b\"\r\n 1 ,\t+2\r\n\"3\",\" 4 \"\r\n");
  EXPECT_THAT(table.numbers[0], ElementsAre(1, 3));
  EXPECT_THAT(table.numbers[1], ElementsAre(2, 4));
  EXPECT_THAT(table.line, ElementsAre(2, 3));
}

TEST(Csv, AcceptsMissingLastLineBreak) { EXPECT_THAT(parse("a,b\n1,2\n3,4").numbers[1], ElementsAre(2, 4)); }

TEST(Csv, AcceptsEmptyLinesAroundTheTable) {
  for (const char* content :
       {"a,b\n1,2\n\n\n", "a,b\n1,2\n  \n\t\n   ", "\n \na,b\n1,2\n", "a,b\r\n1,2\r\n\r\n  \r\n"}) {
    const Table table = parse(content);
    EXPECT_THAT(table.numbers[0], ElementsAre(1)) << content;
  }
  EXPECT_THAT(parse("\n \na,b\n1,2\n").line, ElementsAre(4));
}

TEST(Csv, AcceptsHeaderOnly) {
  EXPECT_EQ(parse("a,b\n").rows(), 0);
  EXPECT_EQ(parse("a,b").rows(), 0);
}

TEST(Csv, ReadsEveryDoubleBack) {
  const Table table = parse("a,b\n0.1,-1.7976931348623157e308\n4.9406564584124654e-324,6.02e+23\n1e-400,.5\n");
  EXPECT_THAT(table.numbers[0], ElementsAre(0.1, 4.9406564584124654e-324, 0.0));
  EXPECT_THAT(table.numbers[1], ElementsAre(-1.7976931348623157e308, 6.02e+23, 0.5));
}

TEST(Csv, ReadsMoreThanOneChunk) {
  std::string content = "a,text,b\n";
  const int rows = 60000;  // about 1.4 MB, which is several chunks, with quoted fields across the chunks' borders
  for (int i = 0; i < rows; ++i) content += std::to_string(i) + ",\"x,\ny\"," + std::to_string(2 * i) + ".5\n";
  const Table table = parse(content);
  ASSERT_EQ(table.rows(), rows);
  for (int i = 0; i < rows; ++i) {
    ASSERT_EQ(table.numbers[0][i], i);
    ASSERT_EQ(table.numbers[1][i], 2 * i + 0.5);
    ASSERT_EQ(table.line[i], 2 + 2 * i);
  }
}

TEST(Csv, TextInANumber) {
  EXPECT_EQ(data_error("a,b\n1,2\n3,four\n"), "f.csv:3: column b: \"four\" is not a number");
  EXPECT_EQ(data_error("a,note,b\n1,\"p\nq\",2\n3,,4x\n"), "f.csv:4: column b: \"4x\" is not a number");
  EXPECT_EQ(data_error("a,b\r\n1,2\r\n3,- 4\r\n"), "f.csv:3: column b: \"- 4\" is not a number");
  for (const char* text : {"0x10", "1e", "+-1", "++1", "+", ".", "1 2", "1;2"})
    EXPECT_THAT(data_error("a,b\n1," + std::string(text) + "\n"), HasSubstr(std::string(text) + "\" is not a number"));
  EXPECT_LT(data_error("a,b\n1," + std::string(5000, 'x') + "\n").size(), 200) << "long text is cut";
  EXPECT_EQ(data_error("a,b\n1,2\n" + std::string(2, '\0') + ",1\n"),
            "f.csv:3: column a: \"\\x00\\x00\" is not a number")
      << "a file system fills the end of a file that was not closed";
}

TEST(Csv, MissingValue) {
  EXPECT_EQ(data_error("a,b\n1,\n"), "f.csv:2: column b: missing value");
  EXPECT_EQ(data_error("a,b\n  ,1\n"), "f.csv:2: column a: missing value");
  EXPECT_EQ(data_error("a,b\n1,\"\"\n"), "f.csv:2: column b: missing value");
  for (const char* text : {"NaN", "nan", "-nan", "inf", "-Inf", "infinity"})
    EXPECT_EQ(data_error("a,b\n1,2\n1," + std::string(text) + "\n"),
              "f.csv:3: column b: missing value (\"" + std::string(text) + "\")");
}

TEST(Csv, TooLargeForADouble) {
  EXPECT_EQ(data_error("a,b\n1e999,2\n"), "f.csv:2: column a: \"1e999\" is too large for a double");
  EXPECT_EQ(data_error("a,b\n-1e99999,2\n"), "f.csv:2: column a: \"-1e99999\" is too large for a double");
}

TEST(Csv, RowOfAnotherWidth) {
  EXPECT_EQ(data_error("a,c,b\n1,2,3\n1,2\n"), "f.csv:3: 2 fields, but the header has 3");
  EXPECT_EQ(data_error("a,b\n1,2\n1,2,3\n"), "f.csv:3: 3 fields, but the header has 2");
  EXPECT_EQ(data_error("a,b\n1\n"), "f.csv:2: 1 field, but the header has 2");
  EXPECT_EQ(data_error("a,b\n1,2\n3"), "f.csv:3: 1 field, but the header has 2");
}

TEST(Csv, EmptyLineBetweenRows) {
  EXPECT_EQ(data_error("a,b\n1,2\n\n3,4\n"), "f.csv:4: empty line before this row");
  EXPECT_EQ(data_error("a,b\r\n1,2\r\n  \r\n3,4\r\n"), "f.csv:4: empty line before this row");
}

TEST(Csv, MalformedQuotes) {
  EXPECT_THAT(data_error("a,note,b\n1,x\"y,2\n"), HasSubstr("f.csv:2: malformed quotes"));
  EXPECT_THAT(data_error("a,note,b\n1,z,2\n1,\"y,2\n"), HasSubstr("f.csv:3: malformed quotes"));
}

TEST(Csv, TheFirstErrorOfTheFileIsReported) {
  EXPECT_THAT(data_error("a,b\n1,2\nx,2\n1,y\n1\n"), HasSubstr("f.csv:3: column a"));
}

TEST(Csv, EmptyFile) {
  for (const char* content : {"", "\n", " \n\t\n", "\r\n\r\n", "\xEF\xBB\xBF", "\xEF\xBB\xBF\n"})
    EXPECT_EQ(message_of<ConfigurationError>([&] { parse(content); }), "f.csv is empty, so it has no header");
}

TEST(Csv, MissingAndRepeatedColumns) {
  EXPECT_EQ(message_of<ConfigurationError>([] {
              parse("time,velL,velR\n", {0, {"vellL"}});
            }),
            "f.csv has no column \"vellL\", did you mean velL?; columns: time, velL, velR");
  EXPECT_EQ(message_of<ConfigurationError>([] {
              parse("time,VelL\n", {0, {"velL"}});
            }),
            "f.csv has no column \"velL\", did you mean VelL?; columns: time, VelL")
      << "case matters";
  EXPECT_EQ(message_of<ConfigurationError>([] { parse("a,b,a\n1,2,3\n"); }), "f.csv has column \"a\" twice");
  EXPECT_EQ(parse("a,b,c,c\n1,2,3,4\n").rows(), 1) << "columns that nobody wants may repeat";
}

TEST(Csv, HeaderOfAFile) {
  const test::TemporaryFolder folder;
  test::write_file(folder.path() / "f.csv",
                   "\n\xEF\xBB\xBF"
                   "a\n");
  test::write_file(folder.path() / "g.csv", "a, \"b, \"\"c\"\"\nd\" ,e\n1,2\",3\n");
  EXPECT_THAT(read_csv_head(folder.path() / "g.csv", {}).names, ElementsAre("a", "b, \"c\"\nd", "e"))
      << "the broken row after the header is not its concern";
  std::string wide = "a0";
  for (int i = 1; i < 20000; ++i) wide += ",a" + std::to_string(i);
  test::write_file(folder.path() / "wide.csv", wide + "\n");
  EXPECT_EQ(read_csv_head(folder.path() / "wide.csv", {}).names.size(), 20000);
}

TEST(Csv, UnreadableFiles) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(message_of<ConfigurationError>([&] { read_csv_head(folder.path() / "absent.csv", {}).names; }),
              testing::AllOf(HasSubstr((folder.path() / "absent.csv").string()), HasSubstr("No such file")));
  EXPECT_THAT(message_of<ConfigurationError>([&] { read_csv_head(folder.path(), {}).names; }),
              HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace modebank
