#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

/// The command `modebank study`.
class StudyCommands : public CliTest {
 protected:
  static const std::vector<std::string>& six() {
    static const std::vector<std::string> keys{"--study.vary", "mixture.components = 1 | 2 | 3", "--study.vary",
                                               "filter.variant = imm | salvi2025"};
    return keys;
  }
  ProgramResult study(std::vector<std::string> options, const std::string& folder = "s") const {
    std::vector<std::string> arguments{"study",           config(),         "--data.root",
                                       file("").string(), "--study.output", file(folder).string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return modebank(arguments);
  }
  ProgramResult study_six(std::vector<std::string> options = {}, const std::string& folder = "s") const {
    options.insert(options.begin(), six().begin(), six().end());
    return study(options, folder);
  }
  std::string text(const std::string& name) const {
    std::ifstream stream(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::vector<std::filesystem::path> trials(const std::string& folder = "s") const {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(file(folder) / "trials"))
      paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
  }
  static std::size_t count(const std::string& in, const std::string& part) {
    std::size_t found = 0;
    for (auto at = in.find(part); at != std::string::npos; at = in.find(part, at + 1)) ++found;
    return found;
  }
};

TEST_F(StudyCommands, FailuresAreOnRecordAndDoNotStopTheOthers) {
  const std::vector<std::string> keys{"--study.vary", "window.length = 10 | 500 | 12"};
  const ProgramResult result = study(keys);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("2 done, 1 failed"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("failed: window.length = 500: "), std::string::npos) << result.out;
  EXPECT_EQ(count(text("s/study.csv"), ",failed,"), 1u);
}

/// The page of a study that still runs, or is not merged, shows the finished runs with their scores.
TEST_F(StudyCommands, AReportOfARunningStudyShowsWhatIsDone) {
  ASSERT_EQ(study_six({"--study.stage", "run"}).status, 0);
  for (const std::size_t lost : {4, 2}) std::filesystem::remove(trials()[lost]);
  const std::size_t done = trials().size();
  ASSERT_EQ(done, 4U);
  const std::string page = file("page.html").string();
  const auto report = [&] { return modebank({"report", file("s").string(), "-o", page}); };
  const ProgramResult running = report();
  ASSERT_EQ(running.status, 0) << running.err;
  EXPECT_NE(running.out.find(std::to_string(done) + " done"), std::string::npos) << running.out;
  EXPECT_EQ(count(text("page.html"), "\"status\":\"done\""), done);
  EXPECT_FALSE(std::filesystem::exists(file("s/study.h5"))) << "a report changes nothing";
  ASSERT_EQ(study_six().status, 0);
  ASSERT_EQ(report().status, 0);
  EXPECT_EQ(count(text("page.html"), "\"status\":\"done\""), 6U);
  // After the table was made, more values are planned.
  ASSERT_EQ(study({"--study.vary", "mixture.components = 1 | 2 | 3 | 4", "--study.vary",
                   "filter.variant = imm | salvi2025", "--study.stage", "plan"})
                .status,
            0);
  const ProgramResult more = report();
  EXPECT_NE(more.out.find("6 done, 2 missing"), std::string::npos) << more.out;
}

/// D12 of the review: reading a device or a pipe must not block.
TEST_F(StudyCommands, DevicesAndPipesAreRefusedByName) {
  ASSERT_EQ(study_six().status, 0);
  const std::filesystem::path trial = trials()[0], log = file("s/log.csv"), plan = file("s/plan.h5");
  const auto put = [](const std::filesystem::path& target, const std::filesystem::path& path) {
    std::filesystem::remove(path);
    std::filesystem::create_symlink(target, path);
  };
  put("/dev/zero", trial);
  for (const char* stage : {"status", "merge"}) {
    const ProgramResult result = study_six({"--study.stage", stage});
    EXPECT_EQ(result.status, 1) << stage;
    EXPECT_NE(result.out.find(trial.stem().string() + ".h5: is not a regular file"), std::string::npos) << result.out;
  }
  const ProgramResult again = study_six();
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find(trial.filename().string()), std::string::npos) << again.err;
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(trial))) << "made anew in its place";
  std::filesystem::remove(trial);
  ASSERT_EQ(mkfifo((trial.parent_path() / (trial.stem().string() + ".failed")).c_str(), 0600), 0);
  EXPECT_EQ(study_six({"--study.stage", "status"}).status, 1);
  std::filesystem::remove(log);
  ASSERT_EQ(mkfifo(log.c_str(), 0600), 0);
  const ProgramResult logged = study_six();
  EXPECT_EQ(logged.status, 2);
  EXPECT_NE(logged.err.find("log.csv' is not a regular file"), std::string::npos) << logged.err;
  put("plan.h5", plan);
  const ProgramResult looped = study_six({"--study.stage", "status"});
  EXPECT_EQ(looped.status, 1);
  EXPECT_EQ(looped.err.find("filesystem error"), std::string::npos) << looped.err;
}

/// A study's folder, with its links, may come from somebody else.
TEST_F(StudyCommands, FilesOfOthersAreNotWrittenThroughLinks) {
  namespace fs = std::filesystem;
  ASSERT_EQ(study_six().status, 0);
  fs::create_directory(file("home"));
  std::vector<std::string> names{"study.csv", "study.best.ini", "study.h5", "log.csv", "plan.claim"};
  const std::string plan = text("s/plan.h5"), trial = trials()[0].filename().string(),
                    failed = "trials/" + trials()[1].stem().string() + ".failed";
  names.push_back("trials/" + trial);
  names.push_back(failed);
  std::vector<fs::path> theirs;
  for (const std::string& name : names) {
    theirs.push_back(file("home") / std::to_string(theirs.size()));
    write_file(theirs.back(), "precious");
    fs::remove(file("s") / name);
    fs::create_symlink(theirs.back(), file("s") / name);
  }
  write("home/plan.h5", plan);
  fs::remove(file("s/plan.h5"));
  fs::create_symlink(file("home/plan.h5"), file("s/plan.h5"));
  const auto in_home = [&] {
    return std::distance(fs::recursive_directory_iterator(file("home")), fs::recursive_directory_iterator());
  };
  const auto before = in_home();
  for (const char* stage : {"merge", "all"}) {
    study_six({"--study.stage", stage});
    for (std::size_t i = 0; i < theirs.size(); ++i)
      EXPECT_EQ(text("home/" + theirs[i].filename().string()), "precious") << names[i] << " after " << stage;
    EXPECT_EQ(text("home/plan.h5"), plan) << stage;
    EXPECT_EQ(in_home(), before) << stage;
  }
  EXPECT_EQ(study_six().status, 0);
  for (const char* name : {"study.csv", "study.best.ini", "study.h5", "log.csv", "plan.claim"})
    EXPECT_FALSE(fs::is_symlink(fs::symlink_status(file("s") / name))) << name;
  for (const fs::path& path : trials())
    EXPECT_TRUE(path.extension() == ".failed" || modebank({"verify", path.string()}).status == 0) << path;
}

TEST_F(StudyCommands, ItsFilesTakeThePlaceOfNoData) {
  const std::string log = text("run_00.csv");
  std::filesystem::create_directory(file("s"));
  for (const char* name : {"s/log.csv", "s/study.csv"}) {
    write(name, log);
    const ProgramResult read = study_six({"--data.inputs", name});
    EXPECT_EQ(read.status, 2) << read.err;
    EXPECT_NE(read.err.find("study.output: " + file(name).string() + " is read by this command"), std::string::npos)
        << read.err;
    const ProgramResult foreign = study_six();
    EXPECT_EQ(foreign.status, 2);
    EXPECT_NE(foreign.err.find(file(name).string() + " exists and is not replaced"), std::string::npos) << foreign.err;
    EXPECT_EQ(text(name), log);
    std::filesystem::remove(file(name));
  }
}

TEST_F(StudyCommands, UsageErrorsLeaveNothing) {
  const ProgramResult nothing = study({});
  EXPECT_EQ(nothing.status, 2);
  EXPECT_NE(nothing.err.find("study.vary is empty"), std::string::npos) << nothing.err;
  const ProgramResult value = study({"--study.vary", "mixture.components = none"});
  EXPECT_EQ(value.status, 2);
  EXPECT_NE(value.err.find("mixture.components the value 'none'"), std::string::npos) << value.err;
  EXPECT_EQ(study_six({"--study.stage", "merge"}).status, 2);  // before a plan is made
  EXPECT_FALSE(std::filesystem::exists(file("s")));
}

}  // namespace
}  // namespace modebank::test
