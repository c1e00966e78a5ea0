// If a table has another dialect or other stamps, the recording must stay the same.
#include <fmt/format.h>

#include <cmath>

#include "io/csv/csv_dialect.hpp"
#include "tests/io/import/log_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::row;
using test::seconds;
using test::table;
using test::u_of;
using test::x_of;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string with_commas(std::string text) {
  for (char& c : text) c = c == '.' ? ',' : c;
  return text;
}

std::string utf16(const std::string& ascii, bool low_first) {
  std::string bytes = low_first ? "\xFF\xFE" : "\xFE\xFF";
  for (const char c : ascii) {
    bytes += low_first ? c : '\0';
    bytes += low_first ? '\0' : c;
  }
  return bytes;
}

class ImportDialect : public test::LogFixture {};

TEST_F(ImportDialect, PlainIsNotTalkedAbout) {
  expect_plain(plain());
  EXPECT_THAT(notes(plain()), IsEmpty());
}

TEST_F(ImportDialect, SemicolonsTabsPipesAndBlanks) {
  for (const char* separator : {";", "\t", "|", " ", "  \t "}) {
    const auto joined = [&](const std::string& a, const std::string& b, const std::string& c) {
      return a + separator + b + separator + c;
    };
    expect_plain(table(joined("time", "x", "u") + "\n",
                       [&](int k) { return joined(seconds(k), fmt::to_string(x_of(k)), fmt::to_string(u_of(k))); }));
  }
}

TEST_F(ImportDialect, DecimalCommas) {
  const std::string content =
      table("time;x;u\n", [](int k) { return with_commas(fmt::format("{};{};{}", seconds(k), x_of(k), u_of(k))); });
  expect_plain(content);
  EXPECT_THAT(notes(content), Contains(AllOf(HasSubstr("semicolons"), HasSubstr("decimal commas"))));
  options.format.decimal = DecimalMark::point;
  EXPECT_THAT(error<DataError>(), HasSubstr(":2: column time: \"0,000000\" is not a time")) << "the option is believed";
}

TEST_F(ImportDialect, WordsForMissingValuesAreCounted) {
  const auto text = [](int k) {
    return fmt::format("{},{},{}", seconds(k),
                       k == 7 || k == 20 ? "NA"
                       : k == 30         ? "-"
                                         : fmt::to_string(x_of(k)),
                       u_of(k));
  };
  write("log.csv", table("time,x,u\n", text));
  EXPECT_THAT(error<DataError>(), HasSubstr("log.csv:9: column x: missing value (\"NA\")"));
  options.missing = Missing::predict;
  const ImportedData data = read(table("time,x,u\n", text));
  EXPECT_TRUE(std::isnan(data.recording.runs[0].state(0, 7)));
  EXPECT_TRUE(std::isnan(data.recording.runs[0].state(0, 30)));
  EXPECT_EQ(data.recording.runs[0].state(0, 8), x_of(8));
  EXPECT_THAT(data.notes, AllOf(Contains(HasSubstr("\"NA\" is read as a missing value 2 times (data.na)")),
                                Contains(HasSubstr("\"-\" is read as a missing value 1 time (data.na)"))));
  options.format.na = {"-999"};
  EXPECT_TRUE(std::isnan(read("time,x,u\n0,1,2\n1,-999.0,2\n2,3,2\n3,4,2\n").recording.runs[0].state(0, 1)));
  write("log.csv", table("time,x,u\n", text));
  EXPECT_THAT(error<DataError>(), HasSubstr("\"NA\" is not a number"));
}

TEST_F(ImportDialect, ADashIsAUnitAndAMissingFirstValueIsNoName) {
  const std::string content =
      table("time,x,u\ns,-,-\n", [](int k) { return fmt::format("{},{},{}", seconds(k), x_of(k), u_of(k)); });
  expect_plain(content);
  EXPECT_EQ(read(content).recording.states[0].unit, "-");
  options.missing = Missing::predict;
  options.time = {"c1"};
  options.state = {"c2"};
  options.input = {"c3"};
  EXPECT_EQ(read("0,NA,1\n1,2,1\n2,3,1\n").recording.runs[0].samples(), 3);
}

TEST_F(ImportDialect, LinesAboveTheTableAreSkipped) {
  const auto line = [](int k) { return fmt::format("{},{},{}", seconds(k), x_of(k), u_of(k)); };
  struct Title {
    std::string text;
    std::size_t lines;
  };
  for (const Title& title : {Title{"\"Plot Title: rig 3\"\n", 1},
                             {"Device: IMU 5\r\nSerial: 1234\r\n\r\nDate: 2025-11-25\r\n", 4},
                             {"sep=,\n", 1},
                             {"A rig, somewhere\n\n", 2},
                             {"\"a title\nof two lines\"\n", 2}}) {
    const std::string content = table(title.text + "time,x,u\n", line);
    options.format.skip_rows = title.lines;
    expect_plain(content);
    EXPECT_THAT(notes(content), Contains(HasSubstr("above the table")));
    options.format.skip_rows = 0;
    options.format.skip_automatic = true;
    expect_plain(content);
    options.format.skip_automatic = false;
  }
  options.format.skip_rows = 2;
  write("log.csv", "a title\n\ntime,x,u\n0,1,2\n1,oh,3\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("log.csv:5: column x: \"oh\"")) << "lines are the file's";
  options.format.skip_rows = 50;
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("is empty after its first 50 lines (data.skip_rows)"));
}

TEST_F(ImportDialect, TheTableIsFoundBehindItsTitle) {
  const auto lines = [](const std::string& text) { return lines_above_table(text, true, {}); };
  const auto numbers = [](const char* row) {
    std::string text;
    for (int k = 0; k < 12; ++k) text += row;
    return text;
  };
  EXPECT_EQ(lines("A towing tank, somewhere\nZig-zag : 10 / -10\n\n" + numbers("0.1\t2\t3\n")), 3U);
  EXPECT_EQ(lines(" TANK, model test\n SHIP1\n Z10\xC2\xB0/5\n Time series of motions\n" + numbers("0.1\t2\t3\n")), 4U);
  EXPECT_EQ(lines("title\nname;value\ns;V\n" + numbers("1,5;2\n")), 1U) << "names and units stay";
  EXPECT_EQ(lines("title\n# t x\n" + numbers("1 2\n")), 1U) << "a comment may name the columns";
  std::string long_title;
  for (int k = 0; k < 60; ++k) long_title += "setting number " + std::to_string(k) + ": on\n";
  EXPECT_EQ(lines(long_title + "t,x\n" + numbers("1,2\n") + numbers("1,2\n") + numbers("1,2\n") + numbers("1,2\n") +
                  numbers("1,2\n") + numbers("1,2\n")),
            60U);
  for (const std::string& none : {plain(), numbers("1,2\n"), "t,x,note\n" + numbers("1,2,\"a, b\"\n"), std::string(),
                                  "\"time\" \"wz\"\n" + numbers("\"1\" 0.1 2\n"),  // R's header lacks one name
                                  std::string("only a title\nand another line\n")})
    EXPECT_EQ(lines(none), 0U) << none;
}

TEST_F(ImportDialect, UnitsRowAndComments) {
  const std::string content = table("# logger v2, robot A\n#\ntime,x,u\ns,[rad/s],m/s\n", [](int k) {
    return std::string(k == 20 ? "# \"restarted\n" : "") + fmt::format("{},{},{}", seconds(k), x_of(k), u_of(k));
  });
  expect_plain(content);
  const Recording recording = read(content).recording;
  EXPECT_EQ(recording.states[0].unit, "rad/s");
  EXPECT_EQ(recording.inputs[0].unit, "m/s");
  options.state_unit = {"deg/s"};
  EXPECT_EQ(read(content).recording.states[0].unit, "deg/s");
}

TEST_F(ImportDialect, Utf16) {
  expect_plain(utf16(plain(), true));
  expect_plain(utf16(plain(), false));
  expect_plain(utf16(plain(), true).substr(2));  // the text without its byte-order mark
}

TEST_F(ImportDialect, NoHeader) {
  options.time = {"c1"};
  options.state = {"c2"};
  options.input = {"c3"};
  const auto line = [](int k) { return fmt::format("{},{},{}", seconds(k), x_of(k), u_of(k)); };
  expect_plain(table("", line));
  EXPECT_THAT(notes(table("", line)), Contains(HasSubstr("columns c1 to c3")));
  options.time = {"time"};
  options.state = {"x"};
  options.input = {"u"};
  expect_plain(table("# time,x,u\n", line));  // numpy.savetxt(header=...)
  options.format.header = HeaderRow::no;
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("columns: c1, c2, c3"));
}

TEST_F(ImportDialect, RowsWithoutTimes) {
  options.time.clear();
  options.rate_hz = 50;
  const ImportedData data = read("x,u\n1,2\n3,4\n5,6\n");
  EXPECT_EQ(data.recording.runs[0].time_s.transpose(), row({0, 0.02, 0.04}));
  EXPECT_EQ(data.recording.runs[0].state, row({1, 3, 5}));
}

TEST_F(ImportDialect, BytesOfNoFormatAndAWrongSeparatorAreNamed) {
  write("log.csv", std::string("\x01\x02\0\x04 time", 9));
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("nor a known format; it begins with the bytes 01 02 00 04"));
  write("log.csv", plain());
  options.format.separator = Separator::semicolon;
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("columns: time,x,u (a single one; set data.separator"));
}

TEST_F(ImportDialect, FormatsThatAreKnownButNotRead) {
  for (const auto& [magic, name] : {std::pair{"PAR1....", "Parquet"},
                                    {"PK\x03\x04", "zip"},
                                    {"\x1F\x8B\x08", "gzip"},
                                    {"\x80\x04\x95", "pickle"},
                                    {"BZh9", "bzip2"},
                                    {"version https://git-lfs.github.com/spec/v1\noid sha256:9b", "Git LFS pointer"},
                                    {"/annex/objects/SHA256E-s100--9b.csv\n", "git annex get"}}) {
    write("log.csv", magic);
    EXPECT_THAT(error<ConfigurationError>(), AllOf(HasSubstr(name), HasSubstr("which modebank does not read; ")));
  }
}

}  // namespace
}  // namespace modebank
