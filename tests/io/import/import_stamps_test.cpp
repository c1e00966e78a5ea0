// Times from typical loggers: units by name, size and spacing; calendars and clocks; one format for all files.
#include <fmt/format.h>

#include <functional>

#include "io/table/stamp_pattern.hpp"
#include "tests/io/import/log_fixture.hpp"

namespace modebank {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

using test::epoch_ns;
using test::log_rows;
using test::stamp_ns;
using test::u_of;
using test::x_of;

constexpr int stamped_rows = 300;

class ImportStamps : public test::ImportFixture {
 protected:
  ImportStamps() {
    options.states.clear();
    options.inputs = "log.csv";
  }

  /// A table with this column of times, and with x and u.
  static std::string table(const std::string& time, const std::function<std::string(int)>& stamp) {
    std::string content = time + ",x,u\n";
    for (int k = 0; k < stamped_rows; ++k) content += fmt::format("{},{},{}\n", stamp(k), 0.25 * (k % 17), k % 3);
    return content;
  }

  /// Reads the run with this column of times. Expects steps of `step_s` +- `tolerance_s`.
  void expect_even(const std::string& time, double step_s, const std::function<std::string(int)>& stamp,
                   double tolerance_s = 1e-9) {
    write("log.csv", table(time, stamp));
    options.time = {time};
    const Trajectory run = import().recording.runs.at(0);
    ASSERT_EQ(run.samples(), stamped_rows) << time;
    for (int k = 1; k < stamped_rows; ++k)
      ASSERT_NEAR(run.time_s(k) - run.time_s(k - 1), step_s, tolerance_s) << time << k;
  }

  std::int64_t origin_ns() const { return import().recording.runs.at(0).time_origin_ns; }
};

TEST_F(ImportStamps, UnitsAreReadFromNames) {
  for (const auto& [name, per_s] : {std::pair{"time [s]", 1.0},
                                    {"time [min]", 1 / 60.0},
                                    {"Time [h]", 1 / 3600.0},
                                    {"hours", 1 / 3600.0},
                                    {"t_h", 1 / 3600.0},
                                    {"t [d]", 1 / 86400.0},
                                    {"Time (days)", 1 / 86400.0},
                                    {"TimeUS", 1e6},
                                    {"Time_US", 1e6},
                                    {"timeMs", 1e3},
                                    {"timestampns", 1e9},
                                    {"t [µs]", 1e6}})
    expect_even(
        name, 0.25, [&, scale = per_s](int k) { return fmt::format("{:.12f}", 0.25 * k * scale); }, 1e-6);
}

TEST_F(ImportStamps, UnitsAreStatedByTheUser) {
  options.time_unit = TimeUnit::min;
  expect_even("clock", 3.0, [](int k) { return fmt::format("{:.3f}", 0.05 * k); });
  options.time_unit = TimeUnit::h;
  expect_even(
      "clock", 180.0, [](int k) { return fmt::format("{:.3f}", 0.05 * k); }, 1e-6);
  options.time_unit = TimeUnit::d;
  expect_even(
      "clock", 4320.0, [](int k) { return fmt::format("{:.3f}", 0.05 * k); }, 1e-6);
}

TEST_F(ImportStamps, StampsSinceBootAreNoEpoch) {
  const auto counted = [](std::int64_t start, std::int64_t step) {
    return [=](int k) { return fmt::to_string(start + step * k); };
  };
  expect_even("timestamp", 0.15, counted(1'000'000'000, 150'000));          // us, 1,000 s after boot
  expect_even("timestamp", 0.004, counted(1'500'000'000, 4'000));           // us
  expect_even("timestamp", 0.15, counted(1'000'000'000'000, 150'000'000));  // ns, 1,000 s of simulated time
  expect_even("timestamp", 0.001, counted(3'000'000'000'000, 1'000'000));   // ns
  expect_even("timestamp", 1.0, counted(1'700'000'000, 1));                 // s since 1970
  expect_even("timestamp", 30.0, counted(1'700'000'000, 30));               // s since 1970
  expect_even("timestamp", 900.0, counted(1'700'000'100, 900));             // s since 1970, every quarter of an hour
  expect_even("timestamp", 86400.0, counted(1'700'006'400, 86'400));        // s since 1970, daily
  expect_even("timestamp", 0.15, counted(1'700'000'000'000, 150));          // ms since 1970
}

TEST_F(ImportStamps, SerialDaysOfSpreadsheetsAndMatlab) {
  for (const double start : {45764.5, 739724.5}) {
    expect_even(
        "Time", 1.0, [&](int k) { return fmt::format("{:.9f}", start + k / 86400.0); }, 2e-4);
    EXPECT_NEAR(static_cast<double>(origin_ns()), 1744891200e9, 1e5) << "2025-04-17T12:00:00Z";
    EXPECT_THAT(import().notes, Contains(HasSubstr("counts days (data.time_unit = d)")));
  }
  expect_even(
      "Time", 60.0, [](int k) { return fmt::format("{:.6f}", 45764.5 + k / 1440.0); }, 0.1);
  expect_even(
      "Timestamp", 10.0, [](int k) { return fmt::format("{:.9f}", 45764.25 + k / 8640.0); }, 1e-3);
  // As seconds, the first column has a rate of 1,440 Hz. As days, its times would not be at full seconds, so it
  // contains seconds. As seconds, the second column has 288 Hz. This is doubtful, because as days its steps are 5
  // minutes.
  expect_even(
      "Time", 1.0 / 1440.0, [](int k) { return fmt::format("{:.9f}", 45764.51234 + k / 1440.0); }, 1e-8);
  expect_even(
      "Time", 1.0 / 288.0, [](int k) { return fmt::format("{:.9f}", 45764.5 + k / 288.0); }, 1e-8);
  EXPECT_THAT(import().notes, Contains(HasSubstr("are taken for seconds (for days set data.time_unit = d)")));
}

TEST_F(ImportStamps, OneUnitForAllFilesOfAPattern) {
  options.inputs = "px4_*.csv";
  options.time = {"timestamp"};
  for (const auto& [early, late] : {std::pair{990, 990}, {990, 1'010}}) {  // alone, px4_early.csv is read as ms
    write("px4_early.csv",
          table("timestamp", [&, step = early](int k) { return fmt::to_string(500'000'000 + step * k); }));
    write("px4_late.csv",
          table("timestamp", [&, step = late](int k) { return fmt::to_string(500'000'000 + step * k); }));
    const std::vector<Trajectory> runs = import().recording.runs;
    EXPECT_NEAR(runs[0].time_s(1) - runs[0].time_s(0), (late > 1'000 ? 1e-6 : 1e-3) * early, 1e-9);
    EXPECT_NEAR(runs[1].time_s(1) - runs[1].time_s(0), (late > 1'000 ? 1e-6 : 1e-3) * late, 1e-9);
  }
  write("px4_late.csv", table("timestamp", [](int k) { return fmt::to_string(1'700'000'000 + k); }));
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("px4_early.csv:2"), HasSubstr("look like milliseconds"),
                                        HasSubstr("px4_late.csv:2"), HasSubstr("data.time_unit = UNIT")));
}

/// 2017-07-30T23:58:00Z, in seconds since 1970.
constexpr std::int64_t start_s = 1'501'459'080;

/// The time k seconds after 23:58:00 on the 30th of July. The format's arguments are day, hour, minute and second.
std::string late_evening(const std::string& form, int k) {
  const int second = 23 * 3600 + 58 * 60 + k;
  return fmt::format(fmt::runtime(form), fmt::arg("d", 30 + second / 86400), fmt::arg("H", second / 3600 % 24),
                     fmt::arg("I", (second / 3600 + 11) % 12 + 1), fmt::arg("M", second / 60 % 60),
                     fmt::arg("S", second % 60), fmt::arg("p", second % 86400 < 43200 ? "AM" : "PM"));
}

TEST_F(ImportStamps, CalendarsAndClocks) {
  for (const char* const form :
       {"{d:02}.07.2017 {H:02}:{M:02}:{S:02}", "07/{d:02}/17 {I:02}:{M:02}:{S:02} {p}", "{d}.7.17 {H}:{M:02}:{S:02}",
        "2017/07/{d:02} {H:02}:{M:02}:{S:02}", "2017-07-{d:02} {H:02}:{M:02}:{S:02}",
        "2017/07/{d:02}/{H:02}:{M:02}:{S:02}.000", "07/{d:02}/2017 {H:02}:{M:02}:{S:02}",
        "{d:02}-Jul-2017 {H:02}:{M:02}:{S:02}", "Jul {d:02} 2017 {H:02}:{M:02}:{S:02}",
        "2017-07-{d:02}T{H:02}:{M:02}:{S:02},000Z", "201707{d:02}T{H:02}{M:02}{S:02}Z"}) {
    expect_even("time", 1.0, [&](int k) { return "\"" + late_evening(form, k) + "\""; });
    EXPECT_EQ(origin_ns(), start_s * 1'000'000'000) << form;
  }
}

TEST_F(ImportStamps, ATimeOfDayGoesOnPastMidnight) {
  expect_even("time", 1.0, [](int k) { return late_evening("{H:02}:{M:02}:{S:02}.000", k); });
  EXPECT_EQ(import().recording.runs[0].time_s(0), 23 * 3600 + 58 * 60);
  expect_even("time", 1.0, [](int k) { return late_evening("{I}:{M:02}:{S:02} {p}", k); });
  expect_even("time", 1.0, [](int k) {
    const int elapsed = 24 * 3600 - 100 + k;
    return fmt::format("{}:{:02}:{:02}", elapsed / 3600, elapsed / 60 % 60, elapsed % 60);
  });
}

TEST_F(ImportStamps, TwoFilesAroundMidnightShareTheirDay) {
  options.inputs = "pro_*.csv";
  options.states = "imu_*.csv";
  write("pro_1.csv", "time,u\n23:59:58,1\n23:59:59,2\n00:00:00,3\n00:00:01,4\n00:00:02,5\n");
  write("imu_1.csv", "time,x\n00:00:00,10\n00:00:01,11\n00:00:02,12\n");
  EXPECT_EQ(import().recording.runs[0].input, test::row({3, 4, 5}));
}

TEST_F(ImportStamps, DayAndMonthAreDecidedByValuesOrRefused) {
  const auto dated = [&](const std::string& name, const std::string& form, int start) {
    write(name, table("time", [&](int k) {
            const int s = start + k;
            return fmt::format(fmt::runtime(form), s / 3600, s / 60 % 60, s % 60);
          }));
  };
  dated("log.csv", "01/02/2009 {:02}:{:02}:{:02}", 36000);
  EXPECT_THAT(
      error<DataError>(),
      AllOf(HasSubstr("log.csv:2: column time: \"01/02/2009 10:00:00\" is 2009-02-01T10:00:00.000Z by %d/%m/%Y"),
            HasSubstr("or 2009-01-02T10:00:00.000Z by %m/%d/%Y"), HasSubstr("data.time_format")));
  options.time_format = "%m/%d/%Y %H:%M:%S";
  EXPECT_EQ(origin_ns(), 1'230'890'400'000'000'000);
  options.time_format = "%d/%m/%Y %H:%M:%S";
  EXPECT_EQ(origin_ns(), 1'233'482'400'000'000'000);
  options.time_format.clear();
  dated("log.csv", "13/02/2009 {:02}:{:02}:{:02}", 36000);
  EXPECT_EQ(origin_ns(), 1'233'482'400'000'000'000 + 12 * 86'400'000'000'000);
  dated("log.csv", "01/01/2009 {:02}:{:02}:{:02}", 36000);
  EXPECT_EQ(origin_ns(), 1'230'804'000'000'000'000) << "both readings are one";
  write("log.csv", table("time", [](int k) {
          const int s = 23 * 3600 + 58 * 60 + k;
          return fmt::format("{:02}/02/2009 {:02}:{:02}:{:02}", 1 + s / 86400, s / 3600 % 24, s / 60 % 60, s % 60);
        }));
  EXPECT_EQ(origin_ns(), 1'233'532'680'000'000'000) << "by the other reading the day leaps over a month";
}

TEST_F(ImportStamps, OneFileDecidesForTheOthers) {
  options.inputs = "run_*.csv";
  for (const auto& [name, day] : {std::pair{"run_1.csv", "01/02"}, {"run_2.csv", "02/13"}})
    write(name, table("time",
                      [&, date = day](int k) { return fmt::format("{}/2009 10:{:02}:{:02}", date, k / 60, k % 60); }));
  EXPECT_EQ(import().recording.runs[0].time_origin_ns, 1'230'890'400'000'000'000) << "January 2";
  write("run_2.csv", table("time", [](int k) { return fmt::format("13.02.2009 10:{:02}:{:02}", k / 60, k % 60); }));
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("run_1.csv:2"), HasSubstr("run_2.csv:2"), HasSubstr("%d.%m.%Y"),
                                        HasSubstr("data.time_format = PATTERN")));
}

/// If a date means the same day in both readings, it does not decide how the dates of other files are read.
TEST_F(ImportStamps, AFileOfOneReadingAloneDoesNotDecide) {
  options.inputs = "run_*.csv";
  const auto dated = [&](const std::string& name, const std::string& date) {
    write(name, table("time", [&](int k) { return fmt::format("{}/2009 10:{:02}:{:02}", date, k / 60, k % 60); }));
  };
  for (const auto& [first, second] : {std::pair{"02/02", "01/02"}, {"01/02", "02/02"}}) {
    dated("run_1.csv", first);
    dated("run_2.csv", second);
    EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("column time: \"01/02/2009 10:00:00\" is 2009-02-01T10:00:00.000Z"),
                                          HasSubstr("or 2009-01-02T10:00:00.000Z"), HasSubstr("data.time_format")));
  }
  dated("run_1.csv", "03/03");
  EXPECT_EQ(import().recording.runs.size(), 2U) << "each of one reading alone";
}

TEST_F(ImportStamps, AFormThatTheTableLacks) {
  write("log.csv", table("time", [](int k) { return fmt::format("2017_211 10h{:02}m{:02}.5", k / 60, k % 60); }));
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("log.csv:2: column time: \"2017_211 10h00m00.5\" is not a time"),
                                        HasSubstr("data.time_format")));
  options.time_format = "%Y_%j %Hh%Mm%S.%f";
  EXPECT_EQ(origin_ns(), 1'501'408'800'500'000'000) << "day 211 of 2017 is July 30";
  options.time_format = "%Y-%m-%d %H:%M:%S";
  EXPECT_THAT(error<DataError>(), HasSubstr("does not fit data.time_format = %Y-%m-%d %H:%M:%S"));
}

TEST_F(ImportStamps, DateAndTimeOfDayInTwoColumns) {
  std::string content = "Time,Date,x,u\n";
  for (int k = 0; k < stamped_rows; ++k) content += late_evening("{H:02}:{M:02}:{S:02}.250,{d:02}.07.2017,1,2\n", k);
  write("log.csv", content);
  options.time = {"Date", "Time"};
  const Trajectory run = import().recording.runs.at(0);
  EXPECT_EQ(run.time_origin_ns, start_s * 1'000'000'000 + 250'000'000);
  EXPECT_EQ(run.time_s(stamped_rows - 1), stamped_rows - 1);
  options.time = {"x", "u"};
  write("log.csv", "x,u\n1.5,2\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("in two columns is not a time"));
}

TEST_F(ImportStamps, RowsFromBeforeTheClockWasSetAreLeftOut) {
  for (const bool runs_on : {false, true}) {  // a clock that stays at 0, or starts at 0
    write("log.csv", table("time", [&](int k) {
            return fmt::format("{:.1f}", k < 5 ? (runs_on ? 0.1 * k : 0.0) : 1.7e9 + 0.1 * k);
          }));
    const ImportedData data = import();
    ASSERT_EQ(data.recording.runs.at(0).samples(), stamped_rows - 5);
    EXPECT_EQ(data.recording.runs[0].time_origin_ns, 1'700'000'000'500'000'000);
    EXPECT_THAT(data.notes, Contains(AllOf(HasSubstr("5 rows are left out, stamped before the clock was set"),
                                           HasSubstr("log.csv:6: 0"), HasSubstr("then 1700000000.5 s"))));
  }
  write("log.csv", table("time", [](int k) { return fmt::format("{:.1f}", k < 200 ? 0.1 * k : 1.7e9 + 0.1 * k); }));
  EXPECT_THAT(error<DataError>(), HasSubstr("differs by orders of magnitude")) << "most of the log";
}

TEST_F(ImportStamps, TheEndOfSummerTimeIsNamed) {
  write("log.csv", table("time", [](int k) {
          const int minute = 2 * 60 + k % 60;
          return fmt::format("2024-10-27 {:02}:{:02}", k < 60 ? minute / 60 : k / 60 + 1, minute % 60);
        }));
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("log.csv:62"), HasSubstr("summer time")));
}

/// The log of LogFixture with other stamps.
class StampsOfALog : public test::LogFixture {};

TEST_F(StampsOfALog, NanosecondsOfAnEpochAreExact) {
  const std::string content = test::table(
      "time,x,u\n", [](int k) { return fmt::format("{},{},{}", epoch_ns + stamp_ns(k), x_of(k), u_of(k)); });
  expect_plain(content, epoch_ns);
  EXPECT_THAT(notes(content), Contains(HasSubstr("column time counts nanoseconds")));
}

TEST_F(StampsOfALog, SecondsOfAnEpochKeepTheirLastDigit) {
  expect_plain(test::table("time,x,u\n",
                           [](int k) {
                             const std::int64_t stamp = epoch_ns + stamp_ns(k);
                             return fmt::format("{}.{:09},{},{}", stamp / 1'000'000'000, stamp % 1'000'000'000, x_of(k),
                                                u_of(k));
                           }),
               epoch_ns);
}

TEST_F(StampsOfALog, UnitsThatSpacingNameOrOptionSay) {
  const auto written = [](const std::string& name, std::int64_t ns_per_unit, std::int64_t start) {
    return test::table(name + ",x,u\n", [&](int k) {
      return fmt::format("{},{},{}", start + stamp_ns(k) / ns_per_unit, x_of(k), u_of(k));
    });
  };
  expect_plain(written("time", 1000, 0));  // stamps are 20000 apart, so they are microseconds
  expect_plain(written("time", 1, 0));     // stamps are 20000000 apart, so they are nanoseconds
  options.time = {"stamp_us"};
  expect_plain(written("stamp_us", 1000, 0));
  options.time = {"t"};
  options.time_unit = TimeUnit::us;
  expect_plain(written("t", 1000, 0));
  options.time_unit = TimeUnit::s;
  EXPECT_EQ(read(written("t", 1000, 0)).recording.runs[0].time_s(1), 20007.0) << "the option is believed";
}

TEST_F(StampsOfALog, WholeNumbersInDoubtAreSecondsAndSaidToBe) {
  const ImportedData data = read("time,x,u\n0,1,2\n10,2,3\n20,3,4\n30,4,5\n");
  EXPECT_EQ(data.recording.runs[0].time_s(1), 10.0);
  EXPECT_THAT(data.notes, Contains(HasSubstr("data.time_unit = ms")));
}

TEST_F(StampsOfALog, IsoTimes) {
  for (const auto& [pattern, shift_h] : {std::pair{"2024-05-01T10:{:02}:{:02}.{:06}Z", 0},
                                         {"2024-05-01 10:{:02}:{:02}.{:06}", 0},
                                         {"2024-05-01T12:{:02}:{:02}.{:06}+02:00", 0},
                                         {"2024-05-01T08:{:02}:{:02}.{:06}-0200", 0}})
    expect_plain(test::table("time,x,u\n",
                             [&, text = pattern](int k) {
                               const std::int64_t us = stamp_ns(k) / 1000;
                               const std::string time = fmt::format(fmt::runtime(text), us / 60'000'000,
                                                                    us / 1'000'000 % 60, us % 1'000'000);
                               return fmt::format("{},{},{}", time, x_of(k), u_of(k));
                             }),
                 epoch_ns + shift_h);
}

TEST_F(StampsOfALog, AStampFarOutIsNamed) {
  for (const int out : {1, 17, log_rows - 1}) {
    write("log.csv", test::table("time,x,u\n", [&](int k) {
            return fmt::format("{},{},{}", k == out ? 0 : epoch_ns + stamp_ns(k), x_of(k), u_of(k));
          }));
    EXPECT_THAT(error<DataError>(), AllOf(HasSubstr(fmt::format("log.csv:{}: column time: 0 s", out + 2)),
                                          HasSubstr("differs by orders of magnitude")));
  }
  write("log.csv", test::table("time,x,u\n", [&](int k) {
          return fmt::format("{},{},{}", (k < 22 ? 0 : epoch_ns) + stamp_ns(k), x_of(k), u_of(k));
        }));
  EXPECT_THAT(error<DataError>(), HasSubstr("log.csv:24: column time")) << "a clock that was set on the way";
}

TEST(StampPattern, ReadsWhatStrptimeReads) {
  const auto seconds = [](const char* pattern, const char* value) {
    const std::optional<Stamp> stamp = StampPattern(pattern).read(value);
    return stamp ? static_cast<double>(stamp->whole) + 1e-9 * stamp->billionths : -1.0;
  };
  EXPECT_EQ(seconds("%Y-%m-%dT%H:%M:%S.%f%z", "2017-07-30T23:58:00.25+02:00"), start_s - 7200 + 0.25);
  EXPECT_EQ(seconds("%Y-%m-%dT%H:%M:%S.%f%z", "2017-07-30T23:58:00"), start_s);
  EXPECT_EQ(seconds("%m/%d/%y %I:%M:%S.%f %p", "07/30/17 11:58:00.5 PM"), start_s + 0.5);
  EXPECT_EQ(seconds("%H:%M:%S:%f", "00:00:01:250"), 1.25);
  EXPECT_EQ(seconds("%H:%M:%S", "26:00:01"), 26 * 3600 + 1);
  for (const char* wrong :
       {"2017-02-29 10:00", "2017-07-30 24:00", "2017-07-30", "2017-07-30 10:00x", "", "1500-01-01 10:00"})
    EXPECT_EQ(seconds("%Y-%m-%d %H:%M", wrong), -1.0) << wrong;
  for (const char* wrong : {"%Q", "%", "%Y", "text", "%S.%f.%f"})
    EXPECT_THROW(StampPattern{wrong}, std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace modebank
