#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>

#include "tests/io/import/import_fixture.hpp"

/// One log that tests write in many ways. It must be read the same.
namespace modebank::test {

inline constexpr int log_rows = 40;
inline constexpr std::int64_t epoch_ns = 1'714'557'600'000'000'000;  // 2024-05-01T10:00:00Z

/// Stamps at 50 Hz with a jitter of microseconds. Every stamp is a whole number of microseconds.
inline std::int64_t stamp_ns(int k) { return 20'000'000LL * k + 1'000LL * (k * 7 % 13); }
inline double x_of(int k) { return 0.25 * k - 0.0625 * (k % 5); }
inline double u_of(int k) { return 1.5 - 0.125 * (k % 7); }

/// A table of time, x and u. `text(k)` writes row k.
inline std::string table(const std::string& head, const std::function<std::string(int)>& text) {
  std::string content = head;
  for (int k = 0; k < log_rows; ++k) content += text(k) + "\n";
  return content;
}

inline std::string seconds(int k) { return fmt::format("{:.6f}", static_cast<double>(stamp_ns(k)) / 1e9); }

class LogFixture : public ImportFixture {
 protected:
  LogFixture() {
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

  /// Expects that `content` gives the values of plain(). Times count from the first sample.
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

}  // namespace modebank::test
