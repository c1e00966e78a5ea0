// The same table in other dialects and with other stamps is the same recording.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::row;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int log_rows = 40;
constexpr std::int64_t epoch_ns = 1'714'557'600'000'000'000;  // 2024-05-01T10:00:00Z

/// 50 Hz and a jitter of microseconds; every stamp is a whole number of these.
std::int64_t stamp_ns(int k) { return 20'000'000LL * k + 1'000LL * (k * 7 % 13); }
double x_of(int k) { return 0.25 * k - 0.0625 * (k % 5); }
double u_of(int k) { return 1.5 - 0.125 * (k % 7); }

/// A table of time, x, u whose rows are written by `text(k)`.
std::string table(const std::string& head, const std::function<std::string(int)>& text) {
  std::string content = head;
  for (int k = 0; k < log_rows; ++k) content += text(k) + "\n";
  return content;
}

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

std::string seconds(int k) { return fmt::format("{:.6f}", static_cast<double>(stamp_ns(k)) / 1e9); }

class ImportDialect : public test::ImportFixture {
 protected:
  ImportDialect() {
    options.states.clear();
    options.inputs = "log.csv";
  }

  ImportedData read(const std::string& content) {
    write("log.csv", content);
    return import();
  }

  static std::string plain() {
    return table("time,x,u\n", [](int k) { return fmt::format("{},{},{}", seconds(k), x_of(k), u_of(k)); });
  }

  /// `content` gives what plain() does, with times from its first sample on.
  void expect_plain(const std::string& content, std::int64_t origin_ns = 0) {
    const Trajectory run = read(content).recording.runs.at(0);
    ASSERT_EQ(run.samples(), log_rows);
    EXPECT_EQ(run.time_origin_ns, origin_ns);
    for (int k = 0; k < log_rows; ++k) {
      EXPECT_EQ(run.time_s(k), static_cast<double>(stamp_ns(k)) / 1e9) << k;
      EXPECT_EQ(run.state(0, k), x_of(k)) << k;
      EXPECT_EQ(run.input(0, k), u_of(k)) << k;
    }
  }

  std::vector<std::string> notes(const std::string& content) { return read(content).notes; }
};

TEST_F(ImportDialect, PlainIsNotTalkedAbout) {
  expect_plain(plain());
  EXPECT_THAT(notes(plain()), IsEmpty());
}

TEST_F(ImportDialect, NanosecondsOfAnEpochAreExact) {
  const std::string content =
      table("time,x,u\n", [](int k) { return fmt::format("{},{},{}", epoch_ns + stamp_ns(k), x_of(k), u_of(k)); });
  expect_plain(content, epoch_ns);
  EXPECT_THAT(notes(content), Contains(HasSubstr("column time counts nanoseconds")));
}

TEST_F(ImportDialect, MillisecondsAndMicrosecondsOfAnEpoch) {
  expect_plain(table("time,x,u\n",
                     [](int k) {
                       return fmt::format("{}.{:03},{},{}", (epoch_ns + stamp_ns(k)) / 1'000'000,
                                          stamp_ns(k) / 1000 % 1000, x_of(k), u_of(k));
                     }),
               epoch_ns);
  expect_plain(table("time,x,u\n",
                     [](int k) { return fmt::format("{},{},{}", (epoch_ns + stamp_ns(k)) / 1000, x_of(k), u_of(k)); }),
               epoch_ns);
}

TEST_F(ImportDialect, SecondsOfAnEpochKeepTheirLastDigit) {
  expect_plain(table("time,x,u\n",
                     [](int k) {
                       const std::int64_t stamp = epoch_ns + stamp_ns(k);
                       return fmt::format("{}.{:09},{},{}", stamp / 1'000'000'000, stamp % 1'000'000'000, x_of(k),
                                          u_of(k));
                     }),
               epoch_ns);
}

TEST_F(ImportDialect, UnitsThatSpacingNameOrOptionSay) {
  const auto written = [](const std::string& name, std::int64_t ns_per_unit, std::int64_t start) {
    return table(name + ",x,u\n",
                 [&](int k) { return fmt::format("{},{},{}", start + stamp_ns(k) / ns_per_unit, x_of(k), u_of(k)); });
  };
  expect_plain(written("time", 1000, 0));  // 20000 apart: microseconds
  expect_plain(written("time", 1, 0));     // 20000000 apart: nanoseconds
  options.time = {"stamp_us"};
  expect_plain(written("stamp_us", 1000, 0));
  options.time = {"t"};
  options.time_unit = TimeUnit::us;
  expect_plain(written("t", 1000, 0));
  options.time_unit = TimeUnit::s;
  EXPECT_EQ(read(written("t", 1000, 0)).recording.runs[0].time_s(1), 20007.0) << "the option is believed";
}

TEST_F(ImportDialect, WholeNumbersInDoubtAreSecondsAndSaidToBe) {
  const ImportedData data = read("time,x,u\n0,1,2\n10,2,3\n20,3,4\n30,4,5\n");
  EXPECT_EQ(data.recording.runs[0].time_s(1), 10.0);
  EXPECT_THAT(data.notes, Contains(HasSubstr("data.time_unit = ms")));
}

TEST_F(ImportDialect, IsoTimes) {
  for (const auto& [pattern, shift_h] : {std::pair{"2024-05-01T10:{:02}:{:02}.{:06}Z", 0},
                                         {"2024-05-01 10:{:02}:{:02}.{:06}", 0},
                                         {"2024-05-01T12:{:02}:{:02}.{:06}+02:00", 0},
                                         {"2024-05-01T08:{:02}:{:02}.{:06}-0200", 0}})
    expect_plain(table("time,x,u\n",
                       [&, text = pattern](int k) {
                         const std::int64_t us = stamp_ns(k) / 1000;
                         const std::string time =
                             fmt::format(fmt::runtime(text), us / 60'000'000, us / 1'000'000 % 60, us % 1'000'000);
                         return fmt::format("{},{},{}", time, x_of(k), u_of(k));
                       }),
                 epoch_ns + shift_h);
}

TEST_F(ImportDialect, SecondsAndNanosecondsInTwoColumns) {
  options.time = {"secs", "nsecs"};
  expect_plain(table("nsecs,secs,x,u\n",
                     [](int k) {
                       const std::int64_t stamp = epoch_ns + stamp_ns(k);
                       return fmt::format("{},{},{},{}", stamp % 1'000'000'000, stamp / 1'000'000'000, x_of(k),
                                          u_of(k));
                     }),
               epoch_ns);
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
  EXPECT_THAT(error<DataError>(), HasSubstr(":2: column time: \"0,000000\" is no time")) << "the option is believed";
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
  expect_plain(utf16(plain(), true).substr(2));  // without its mark
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

TEST_F(ImportDialect, RobotArmOfDaisy) {
  MODEBANK_NEEDS_SHARED_DATA();
  options.root = (test::shared_data_dir() / "sysid_classic").string();
  options.inputs = "robot_arm.dat";
  options.time.clear();
  options.rate_hz = 1;
  options.input = {"c1"};
  options.state = {"c2"};
  const Trajectory run = import().recording.runs.at(0);
  ASSERT_EQ(run.samples(), 1024);
  EXPECT_EQ(run.input(0, 0), 2.2183165e-01);
  EXPECT_EQ(run.state(0, 4), 1.2806267e-01);
  const auto sd = [](const Eigen::MatrixXd& x) { return std::sqrt((x.array() - x.mean()).square().mean()); };
  EXPECT_NEAR(sd(run.input), 0.164430, 1e-4) << "as the data's README says";
  EXPECT_NEAR(sd(run.state), 0.275098, 2e-4);
}

TEST_F(ImportDialect, AStampFarOutIsNamed) {
  for (const int out : {0, 1, 17, log_rows - 1}) {
    write("log.csv", table("time,x,u\n", [&](int k) {
            return fmt::format("{},{},{}", k == out ? 0 : epoch_ns + stamp_ns(k), x_of(k), u_of(k));
          }));
    EXPECT_THAT(error<DataError>(), AllOf(HasSubstr(fmt::format("log.csv:{}: column time: 0 s", out + 2)),
                                          HasSubstr("out by orders of magnitude")));
  }
  write("log.csv", table("time,x,u\n", [&](int k) {
          return fmt::format("{},{},{}", (k < 12 ? 0 : epoch_ns) + stamp_ns(k), x_of(k), u_of(k));
        }));
  EXPECT_THAT(error<DataError>(), HasSubstr("log.csv:14: column time")) << "a clock that was set on the way";
}

TEST_F(ImportDialect, UnitsStandInBracketsOfTheHeader) {
  write("log.csv", table("t [ms],x [deg/s],u (m/s)\n", [&](int k) {
          return fmt::format("{:.6f},{},{}", static_cast<double>(stamp_ns(k)) / 1e6, x_of(k), u_of(k));
        }));
  options.time = {"t [ms]"};
  options.state = {"x [deg/s]"};
  options.input = {"u (m/s)"};
  const ImportedData data = import();
  EXPECT_EQ(data.recording.states.front().unit, "deg/s");
  EXPECT_EQ(data.recording.inputs.front().unit, "m/s");
  EXPECT_NEAR(data.recording.runs.front().time_s(log_rows - 1), static_cast<double>(stamp_ns(log_rows - 1)) / 1e9,
              1e-9);
}

TEST_F(ImportDialect, DisorderIsExplained) {
  write("log.csv", table("stamp.secs,x,u\n", [&](int k) { return fmt::format("{},{},{}", 100 + k / 10, 1, 2); }));
  options.time = {"stamp.secs"};
  EXPECT_THAT(error<DataError>(), HasSubstr("data.time = stamp.secs, stamp.nsecs"));
  write("log.csv", table("time,x,u\n", [&](int k) { return fmt::format("{},{},{}", 0.1 * (k % 20), 1, 2); }));
  options.time = {"time"};
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("log.csv:22:"), HasSubstr("data.run = ")));
}

TEST_F(ImportDialect, BytesOfNoFormatAndAWrongSeparatorAreNamed) {
  write("log.csv", std::string("\x01\x02\0\x04 time", 9));
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("no known format: it begins with the bytes 01 02 00 04"));
  write("log.csv", plain());
  options.format.separator = Separator::semicolon;
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("columns: time,x,u (a single one: data.separator"));
}

TEST_F(ImportDialect, FormatsThatAreKnownButNotRead) {
  for (const auto& [magic, name] : {std::pair{"PAR1....", "Parquet"},
                                    {"PK\x03\x04", "zip"},
                                    {"\x1F\x8B\x08", "gzip"},
                                    {"\x80\x04\x95", "pickle"},
                                    {"BZh9", "bzip2"}}) {
    write("log.csv", magic);
    EXPECT_THAT(error<ConfigurationError>(), AllOf(HasSubstr(name), HasSubstr("not read here; ")));
  }
}

}  // namespace
}  // namespace modebank
