// A folder of results: the rows of the index, and the pages that are made again.
#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>

#include "app/report/site/index_row.hpp"
#include "app/report/site/site_record.hpp"
#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Site : public CliTest {
 protected:
  Site() {
    fs::create_directories(results / "older");
    EXPECT_EQ(run({"--archive.output", (results / "a.h5").string()}).status, 0);
    EXPECT_EQ(run({"--archive.output", (results / "older/b.h5").string(), "--window.length", "25"}).status, 0);
  }

  ProgramResult make() const { return modebank({"report", results.string(), "-o", site.string(), "--json"}); }
  /// Files that `report` wrote or removed. Their names are relative to the site.
  std::vector<std::string> files(const char* member) const {
    const ProgramResult made = make();
    EXPECT_EQ(made.status, 0) << made.err;
    std::vector<std::string> names;
    for (const std::string& name : json::parse(made.out).at(member).get<std::vector<std::string>>())
      names.push_back(fs::path(name).lexically_relative(site).string());
    return names;
  }
  /// Rows of the index, by the name of the archive.
  std::map<std::string, json> rows() const {
    const std::string page = read_file(site / "index.html"), open = "id=\"page-data\">";
    const auto from = page.find(open) + open.size();
    const json data = json::parse(page.substr(from, page.find("</script>", from) - from));
    std::map<std::string, json> found;
    for (const json& row : data.at("rows")) found[row.at("name")] = row;
    return found;
  }

  const fs::path results = file("results"), site = file("site");
  const std::string a_page = "pages/a.html", b_page = "pages/older/b.html";
};

TEST_F(Site, LinesHoldWhatTheArchivesHold) {
  ASSERT_EQ(make().status, 0);
  const auto lines = rows();
  ASSERT_EQ(lines.size(), 2u);
  const json& line = lines.at("older/b.h5");
  EXPECT_EQ(line.at("page"), b_page);
  EXPECT_EQ(line.at("archive"), (results / "older/b.h5").string());
  const Archive archive = read_archive(results / "older/b.h5");
  EXPECT_EQ(line.at("created"), archive.provenance.created);
  EXPECT_EQ(line.at("answer"), name_of(archive.finding->answer));
  EXPECT_EQ(line.at("modes"), archive.bank->mode_count());
  for (const SummaryRow& row : archive.summary)
    if (row.filter == "bank" && row.role == Role::test && row.run == "*") {
      EXPECT_EQ(line.at("log_score"), row.log_score);
      EXPECT_EQ(line.at("coverage_95"), row.coverage_95);
    }
}

TEST_F(Site, ThePageOfAnArchiveIsTheOneOfReport) {
  ASSERT_EQ(make().status, 0);
  ASSERT_EQ(modebank({"report", (results / "a.h5").string(), "-o", file("alone.html").string()}).status, 0);
  EXPECT_EQ(read_file(site / a_page), read_file(file("alone.html")));
}

TEST_F(Site, WhatChangedIsMadeAgain) {
  EXPECT_THAT(files("written"), ElementsAre(a_page, b_page, "index.html"));
  const std::string before = read_file(site / "index.html");
  EXPECT_THAT(files("written"), ElementsAre("index.html"));
  EXPECT_EQ(read_file(site / "index.html"), before);
  ASSERT_EQ(run({"--archive.output", (results / "a.h5").string(), "--window.length", "22"}).status, 0);
  EXPECT_THAT(files("written"), ElementsAre(a_page, "index.html"));
  fs::remove(site / b_page);
  EXPECT_THAT(files("written"), ElementsAre(b_page, "index.html"));
  // The record as it is after an earlier version, and after a killed process.
  app::report::SiteRecord record = app::report::read_site_record(site);
  record.at("a.h5").maker = "modebank 0.0.1";
  record.at("older/b.h5").archive = "";
  app::report::write_site_record(site, record);
  EXPECT_THAT(files("written"), ElementsAre(a_page, b_page, "index.html"));
}

TEST_F(Site, PagesOfArchivesThatWentGoOthersStay) {
  ASSERT_EQ(make().status, 0);
  write("site/pages/mine.html", "<!DOCTYPE html>");
  fs::remove(results / "older/b.h5");
  EXPECT_THAT(files("removed"), ElementsAre(b_page));
  EXPECT_FALSE(fs::exists(site / "pages/older"));
  EXPECT_TRUE(fs::exists(site / "pages/mine.html"));
  fs::remove(results / "a.h5");
  EXPECT_THAT(files("removed"), ElementsAre(a_page));
  EXPECT_THAT(rows(), IsEmpty());
}

TEST_F(Site, ABrokenArchiveIsALineThatSaysWhy) {
  ASSERT_EQ(make().status, 0);
  std::string bytes = read_file(results / "a.h5");
  bytes[bytes.size() / 2] ^= 1;
  write("results/a.h5", bytes);
  write("results/c.h5", "time,wz\n");
  const ProgramResult made = make();
  EXPECT_EQ(made.status, 0);
  const json problems = json::parse(made.out).at("problems");
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].at("file"), "a.h5");
  const auto lines = rows();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_THAT(lines.at("a.h5").at("problem").get<std::string>(), HasSubstr("SHA-256"));
  EXPECT_THAT(lines.at("c.h5").at("problem").get<std::string>(), HasSubstr("not a modebank archive"));
  EXPECT_FALSE(lines.at("a.h5").contains("page"));
  EXPECT_FALSE(fs::exists(site / a_page));  // the page showed earlier content of the archive
  EXPECT_TRUE(fs::exists(site / b_page));
}

TEST_F(Site, AStudyIsOneLineWithItsPage) {
  const std::vector<std::string> study{"study", config(), "--study.vary", "window.length = 20 | 25", "--study.output"};
  std::vector<std::string> words = study;
  words.push_back((results / "s").string());
  ASSERT_EQ(modebank(words).status, 0);
  const std::vector<std::string> written = files("written");
  ASSERT_EQ(written.size(), 6u);  // for the study, these are its page and the pages of two runs
  EXPECT_TRUE(fs::exists(site / "pages/s/study.html"));
  const auto lines = rows();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines.at("s").at("kind"), "study");
  EXPECT_EQ(lines.at("s").at("page"), "pages/s/study.html");
  EXPECT_THAT(files("written"), ElementsAre("index.html"));
  fs::remove_all(results / "s");
  EXPECT_EQ(files("removed").size(), 3u);
  EXPECT_FALSE(fs::exists(site / "pages/s"));
}

/// An unfinished study has a row. It also has the page of `report STUDY`, which is made anew each time.
TEST_F(Site, AStudyThatGoesOnIsALineWithWhatIsDone) {
  const std::string folder = (results / "s").string();
  std::vector<std::string> half{"study",          config(), "--study.vary",  "window.length = 20 | 25 | 30",
                                "--study.output", folder,   "--study.stage", "run",
                                "--study.shard",  "0/3"};
  ASSERT_EQ(modebank(half).status, 0);
  ASSERT_FALSE(fs::exists(results / "s/study.h5"));
  EXPECT_EQ(json::parse(make().out).at("problems").size(), 0u);
  EXPECT_EQ(rows().at("s").at("text"), "1 of 3 runs are done.");
  EXPECT_EQ(rows().at("s").at("page"), "pages/s/study.html");
  EXPECT_TRUE(fs::exists(site / "pages/s/study.html"));
  half.resize(half.size() - 4);
  ASSERT_EQ(modebank(half).status, 0);
  EXPECT_THAT(files("written"), ::testing::Contains("pages/s/study.html"));
  EXPECT_EQ(rows().at("s").at("text"), "3 of 3 runs are done.");
  EXPECT_THAT(files("written"), ElementsAre("index.html"));
}

TEST_F(Site, AFolderOfOtherFilesIsRefused) {
  fs::create_directories(file("site_of_others"));
  write("site_of_others/index.html", "<!DOCTYPE html>");
  const ProgramResult others = modebank({"report", results.string(), "-o", file("site_of_others").string()});
  EXPECT_EQ(others.status, 2);
  EXPECT_THAT(others.err, HasSubstr("has files that report did not write"));
  EXPECT_TRUE(read_file(file("site_of_others/index.html")) == "<!DOCTYPE html>");
  const ProgramResult itself = modebank({"report", results.string(), "-o", results.string()});
  EXPECT_EQ(itself.status, 2);
  fs::create_directories(file("empty"));
  const ProgramResult empty = modebank({"report", file("empty").string(), "-o", site.string()});
  EXPECT_EQ(empty.status, 2);
  EXPECT_THAT(empty.err, HasSubstr("has no archive"));
  EXPECT_FALSE(fs::exists(site));
}

/// Even if a record was edited by hand, only pages are removed.
TEST_F(Site, ARecordNamesPagesAlone) {
  ASSERT_EQ(make().status, 0);
  for (const std::string outside : {"../test.ini", "pages/../../test.ini", "/etc/passwd", ""}) {
    app::report::SiteRecord record{{"gone.h5", {"", "", {outside}}}};
    app::report::write_site_record(site, record);
    EXPECT_THROW(app::report::read_site_record(site), DataError) << outside;
  }
  EXPECT_EQ(make().status, 1);
  EXPECT_TRUE(fs::exists(config()));
}

/// Compares an archive with itself.
TEST_F(Site, AnArchiveBesideItself) {
  const std::string archive = (results / "a.h5").string();
  ASSERT_EQ(modebank({"report", archive, archive, "-o", file("both.html").string()}).status, 0);
  EXPECT_THAT(read_file(file("both.html")), HasSubstr("predict equally well"));
}

}  // namespace
}  // namespace modebank::test
