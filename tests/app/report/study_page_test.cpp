#include "app/report/page/study_page.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "app/study/answers/merge_study.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using app::StudyTable;
using app::TrialRow;
using app::TrialStatus;

/// Six runs over two keys; the values of one key are words. The fifth run has failed.
StudyTable example_table() {
  StudyTable table;
  table.varied_keys = {"mixture.components", "mixture.covariance"};
  table.score_names = {"modes", "bank_train_log_score", "bank_test_log_score", "bank_test_nis_above"};
  for (int i = 0; i < 6; ++i) {
    TrialRow row;
    row.key = std::string(63, 'a') + std::to_string(i);
    row.varied = {std::to_string(i / 2 + 1), i % 2 ? "full" : "diagonal"};
    row.seed = 1;
    row.status = i == 4 ? TrialStatus::failed : TrialStatus::done;
    row.message = i == 4 ? "<b>out of luck</b>" : "";
    row.scores = {i / 2 + 1.0, 0.25 * i, i == 3 ? 7.5 : 0.5 * i, 0.01 * i};
    if (i == 4) row.scores.assign(4, std::numeric_limits<double>::quiet_NaN());
    table.rows.push_back(row);
  }
  return table;
}

StudyFile file_of(const StudyTable& table) {
  StudyFile file;
  file.table = "study";
  file.columns = app::table_columns(table);
  return file;
}

TEST(StudyPage, TheTableComesBackFromItsColumns) {
  const StudyTable table = example_table(), read = app::report::study_table_of(file_of(table));
  EXPECT_EQ(read.varied_keys, table.varied_keys);
  EXPECT_EQ(read.score_names, table.score_names);
  ASSERT_EQ(read.rows.size(), table.rows.size());
  for (std::size_t i = 0; i < read.rows.size(); ++i) {
    EXPECT_EQ(read.rows[i].key, table.rows[i].key);
    EXPECT_EQ(read.rows[i].varied, table.rows[i].varied);
    EXPECT_EQ(read.rows[i].status, table.rows[i].status);
    EXPECT_EQ(read.rows[i].message, table.rows[i].message);
    EXPECT_EQ(read.rows[i].scores.size(), table.rows[i].scores.size());
  }
  EXPECT_EQ(read.rows[3].scores, table.rows[3].scores);
}

TEST(StudyPage, ATableThatIsNoStudysSaysWhatIsMissing) {
  StudyFile file = file_of(example_table());
  file.columns.erase(file.columns.begin() + 4);  // removes the column of the status
  try {
    app::report::study_table_of(file);
    FAIL() << "no error";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("no column status"), std::string::npos) << error.what();
  }
}

TEST(StudyPage, HoldsEveryRunAndTheBestOne) {
  const StudyTable table = example_table();
  std::vector<app::report::TrialPlace> places(table.rows.size());
  places[3] = {"study_runs/key3.html", "trials/key3.h5"};
  const nlohmann::json study = app::report::study_page(file_of(table), table, places, "study").data.at("study");
  ASSERT_EQ(study.at("rows").size(), 6u);
  EXPECT_EQ(study.at("best").at("row"), 3);
  EXPECT_EQ(study.at("standard_score"), "bank_test_log_score");
  const auto& columns = study.at("columns");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].at("name") == "bank_test_log_score") {
      EXPECT_EQ(study.at("rows")[3].at("cells")[c].at("v"), 7.5);
      EXPECT_TRUE(study.at("rows")[4].at("cells")[c].at("v").is_null());
      EXPECT_EQ(columns[c].at("goal").at("kind"), "higher");
    }
  }
  EXPECT_EQ(study.at("rows")[3].at("page"), "study_runs/key3.html");
}

class ReportKinds : public CliTest {};

TEST_F(ReportKinds, TwoArchivesMakeOnePage) {
  ASSERT_EQ(run().status, 0);
  const std::string other = file("other.h5").string(), page = file("compare.html").string();
  ASSERT_EQ(modebank({"run", config(), "--archive.output", other, "--data.root", file("").string(),
                      "--mixture.components", "1"})
                .status,
            0);
  const ProgramResult result = modebank({"report", archive(), other, "-o", page});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(page));
}

TEST_F(ReportKinds, AFolderThatIsNoStudysAndTooManyFilesAreRefused) {
  const std::string page = file("page.html").string();
  const ProgramResult folder = modebank({"report", file("").string(), "-o", page});
  EXPECT_EQ(folder.status, 2);
  EXPECT_NE(folder.err.find("has no archive (*.h5) and no study"), std::string::npos) << folder.err;
  EXPECT_EQ(modebank({"report", "a", "b", "c"}).status, 2);
  EXPECT_EQ(modebank({"report"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(page));
}

}  // namespace
}  // namespace modebank::test
