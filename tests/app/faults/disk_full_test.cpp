// Runs every command on a disk that becomes full, so that a call that writes to a file fails. Existing files must stay.
// New files must be complete or absent. The message must name the file and the reason.
// By default, a random sample of the calls fails, with a fixed seed. With MODEBANK_FAULTS=all (`make faults`), each
// call fails once.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <random>
#include <sstream>

#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Files of a folder and its subfolders: relative name and content.
using Content = std::map<std::string, std::string>;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Content content_of(const fs::path& folder) {
  Content content;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) content[entry.path().lexically_relative(folder).string()] = bytes_of(entry.path());
  return content;
}

/// Output of failing_call: the number of calls, and the calls that failed.
struct Report {
  std::size_t calls = 0;
  std::vector<std::string> failed;  ///< "write /path"
};

Report read_report(const fs::path& path) {
  Report report;
  std::istringstream lines(bytes_of(path));
  std::string line;
  if (std::getline(lines, line)) report.calls = std::stoul(line);
  while (std::getline(lines, line)) report.failed.push_back(line);
  return report;
}

/// Names that a message may use for a call's file: the file without the parts of a temporary name, and the folders
/// above it.
std::vector<std::string> names_in(const std::string& failed) {
  if (failed.ends_with("standard output")) return {"standard output"};
  std::vector<std::string> names;
  for (const fs::path& part : fs::path(failed.substr(failed.find(' ') + 1))) {
    std::string name = part.string();
    if (name.size() > 1 && name.front() == '.') name = name.substr(1, name.find(".modebank-") - 1);
    names.push_back(name);
  }
  return names;
}

}  // namespace

class DiskFull : public CliTest {
 protected:
  DiskFull() {
    fs::create_directories(file("whole"));
    for (unsigned r = 0; r < 4; ++r) write("whole/run_0" + std::to_string(r) + ".csv", csv_run(80, r + 1));
    write("whole/test.ini", config_text());
    write("whole/sim.ini",
          "[data]\nstate = wz\ninput = left, right\n[simulate]\nsystem = three_grips\noutput = sim\n"
          "runs = 4\nsamples = 80\nrate_hz = 6.5\nstate_rate_hz = 6.5\n");
  }

  /// Makes an archive of the runs. The commands report, track and export need it.
  void make_archive() const { EXPECT_EQ(in("whole", {"run", "test.ini", "--archive.output", "two.h5"}).status, 0); }

  /// Runs the command in a subfolder of the fixture's folder.
  ProgramResult in(const std::string& folder, const std::vector<std::string>& arguments,
                   const std::string& which = "0") const {
    // Relative names refer to this folder. A shell sends the lines to `track`.
    std::string line = "cd \"$1\" && shift && exec \"$@\"";
    if (arguments.front() == "track") line += " < run_01.csv";
    std::vector<std::string> whole{
        MODEBANK_FAILING_CALL, which,  file("report").string(), file(folder).string(), "/bin/sh", "-c", line, "sh",
        file(folder).string(), program};
    whole.insert(whole.end(), arguments.begin(), arguments.end());
    return run_program(whole);
  }

  /// Numbers of the calls that shall fail: all calls, or a sample.
  static std::vector<std::size_t> chosen(std::size_t calls, std::size_t few) {
    std::vector<std::size_t> numbers(calls);
    std::iota(numbers.begin(), numbers.end(), std::size_t{1});
    const char* const effort = std::getenv("MODEBANK_FAULTS");
    if (effort && std::string(effort) == "all") return numbers;
    std::shuffle(numbers.begin(), numbers.end(), std::mt19937_64(calls));
    numbers.resize(std::min(numbers.size(), few));
    return numbers;
  }

  /// Runs the command without failures. Then, for each chosen call, runs it twice: only this call fails, and this call
  /// and all later calls fail.
  void every_call(const std::vector<std::string>& arguments, std::size_t few = 5) {
    fs::copy(file("whole"), file("undisturbed"), fs::copy_options::recursive);
    const ProgramResult fine = in("undisturbed", arguments);
    ASSERT_EQ(fine.status, 0) << fine.err;
    const Report report = read_report(file("report"));
    ASSERT_GT(report.calls, 0U);
    RecordProperty("calls", static_cast<int>(report.calls));
    after_ = content_of(file("undisturbed"));
    before_ = content_of(file("whole"));
    for (const std::size_t k : chosen(report.calls, few))
      for (const char* from_there : {"", "+"}) fail_at(std::to_string(k) + from_there, arguments);
  }

  static constexpr const char* program = MODEBANK_PROGRAM;

 private:
  Content before_, after_;

  void fail_at(const std::string& which, const std::vector<std::string>& arguments) {
    fs::remove_all(file("full"));
    fs::copy(file("whole"), file("full"), fs::copy_options::recursive);
    const ProgramResult result = in("full", arguments, which);
    const Report report = read_report(file("report"));
    if (report.failed.empty()) return;  // this time the program made fewer calls, so none has failed
    SCOPED_TRACE("call " + which + ", " + report.failed.front() + "; status " + std::to_string(result.status) + ": " +
                 result.err);
    const Content now = content_of(file("full"));
    for (const auto& [name, bytes] : before_) {
      ASSERT_EQ(now.count(name), 1U) << name << " is lost";
      EXPECT_TRUE(now.at(name) == bytes || is_whole(name, now.at(name))) << name << " was there and is damaged";
    }
    for (const auto& [name, bytes] : now) {
      EXPECT_EQ(name.find(".tmp"), std::string::npos) << name << " is left behind";
      EXPECT_TRUE(before_.count(name) || is_whole(name, bytes)) << name << " is not whole";
    }
    if (result.status == 0) {
      EXPECT_TRUE(may_pass(report, result, now)) << "it passes for a success";
      return;
    }
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, HasSubstr("No space left on device"));
    EXPECT_TRUE(names_a_file(report, result.err)) << "no file is named";
  }

  /// Whether a file equals that of an undisturbed command. Times in the file may differ, so only its lines are counted.
  bool is_whole(const std::string& name, const std::string& bytes) const {
    if (name.ends_with("log.csv")) return bytes.empty() || bytes.back() == '\n';  // the log grows by whole lines
    if (name.ends_with(".h5")) return verify_archive(file("full") / name).ok();
    const auto expected = after_.find(name);
    if (expected == after_.end()) return bytes.empty() || bytes.back() == '\n';
    const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
    return bytes == expected->second || (lines(bytes) == lines(expected->second) && bytes.back() == '\n');
  }

  /// Whether the command may succeed in spite of the failure. It may if all files are complete (a file closed after its
  /// sync, a probe), or if a warning names the missing file.
  bool may_pass(const Report& report, const ProgramResult& result, const Content& now) const {
    if (result.err.find("No space left on device") != std::string::npos) return names_a_file(report, result.err);
    return std::all_of(after_.begin(), after_.end(), [&](const auto& entry) {
      return now.count(entry.first) == 1 || entry.first.find("cache/") != std::string::npos;
    });
  }

  /// Whether the message names a file in the folder. It is not enough if it names a folder above.
  bool names_a_file(const Report& report, const std::string& text) const {
    const std::string above = file("full").string();
    return std::any_of(report.failed.begin(), report.failed.end(), [&](std::string failed) {
      if (const std::size_t at = failed.find(above); at != std::string::npos) failed.erase(at, above.size() + 1);
      const std::vector<std::string> names = names_in(failed);
      return std::any_of(names.begin(), names.end(),
                         [&](const std::string& name) { return text.find(name) != std::string::npos; });
    });
  }
};

TEST_F(DiskFull, OfRun) { every_call({"run", "test.ini", "--archive.output", "out.h5"}); }

TEST_F(DiskFull, OfRunThatReplacesItsArchive) {
  make_archive();
  every_call({"run", "test.ini", "--archive.output", "two.h5"}, 3);
}

TEST_F(DiskFull, OfReport) {
  make_archive();
  every_call({"report", "two.h5", "-o", "page.html"});
}

TEST_F(DiskFull, OfSimulate) { every_call({"simulate", "sim.ini"}); }

TEST_F(DiskFull, OfTrack) {
  make_archive();
  every_call({"track", "two.h5"});
}

TEST_F(DiskFull, OfExport) {
  make_archive();
  every_call({"export", "two.h5", "--to", "c", "-o", "bank.c"}, 2);
  fs::remove_all(file("undisturbed"));
  every_call({"export", "two.h5", "--to", "json"}, 1);
}

TEST_F(DiskFull, OfStudy) {
  every_call({"study", "test.ini", "--study.vary", "mixture.components = 1 | 2", "--study.output", "study",
              "--study.jobs", "1", "--bank.refine", "none"},
             4);
}

}  // namespace modebank::test
