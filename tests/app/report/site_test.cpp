// A folder of results: the rows of the index, and the pages that are made again.
#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Site : public CliTest {
 protected:
  Site() {
    fs::create_directories(results / "older");
    EXPECT_EQ(run({"--archive.output", (results / "a.h5").string()}).status, 0);
    EXPECT_EQ(run({"--archive.output", (results / "older/b.h5").string(), "--window.length", "25"}).status, 0);
  }

  ProgramResult make() const { return modebank({"report", results.string(), "-o", site.string(), "--json"}); }
  /// Files that `report` wrote. Their names are relative to the site.
  std::vector<std::string> written() const {
    const ProgramResult made = make();
    EXPECT_EQ(made.status, 0) << made.err;
    std::vector<std::string> names;
    for (const std::string& name : json::parse(made.out).at("written").get<std::vector<std::string>>())
      names.push_back(fs::path(name).lexically_relative(site).string());
    return names;
  }
  /// The row of the index with this text.
  std::string row(const std::string& text) const {
    std::istringstream page(read_file(site / "index.html"));
    for (std::string line; std::getline(page, line);)
      if (line.find(text) != std::string::npos && line.starts_with("<tr><td>")) return line;
    return "none";
  }

  const fs::path results = file("results"), site = file("site");
  const std::string a_page = "pages/a.html", b_page = "pages/older/b.html";
};

TEST_F(Site, RowsHoldWhatTheArchivesHold) {
  ASSERT_EQ(make().status, 0);
  const std::string line = row("older/b.h5");
  EXPECT_THAT(line, HasSubstr("<a href=\"" + b_page + "\">older/b.h5</a>"));
  const Archive archive = read_archive(results / "older/b.h5");
  EXPECT_THAT(line, HasSubstr(archive.provenance.created));
  EXPECT_THAT(line, HasSubstr(std::string(archive.finding->text)));
}

/// Names of files are text, and addresses of pages lead to them.
TEST_F(Site, NamesAreNoMarkup) {
  fs::rename(results / "a.h5", results / "<b>#1 50 %.h5");
  ASSERT_EQ(make().status, 0);
  EXPECT_THAT(row("50 %"), HasSubstr("<a href=\"pages/%3Cb%3E%231%2050%20%25.html\">&lt;b&gt;#1 50 %.h5</a>"));
  EXPECT_TRUE(fs::exists(site / "pages/<b>#1 50 %.html"));
}

TEST_F(Site, WhatChangedIsMadeAgain) {
  EXPECT_THAT(written(), ElementsAre(a_page, b_page, "index.html"));
  const std::string before = read_file(site / "index.html");
  EXPECT_THAT(written(), ElementsAre("index.html"));
  EXPECT_EQ(read_file(site / "index.html"), before);
  ASSERT_EQ(run({"--archive.output", (results / "a.h5").string(), "--window.length", "22"}).status, 0);
  EXPECT_THAT(written(), ElementsAre(a_page, "index.html"));
  fs::remove(site / b_page);
  EXPECT_THAT(written(), ElementsAre(b_page, "index.html"));
  // An older archive takes the place of a newer one.
  fs::last_write_time(results / "a.h5", fs::last_write_time(results / "a.h5") - std::chrono::hours(1));
  EXPECT_THAT(written(), ElementsAre(a_page, "index.html"));
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
  for (const auto& [name, why] : {std::pair{"a.h5", "SHA-256"}, std::pair{"c.h5", "not a modebank archive"}}) {
    EXPECT_THAT(row(name), HasSubstr(why));
    EXPECT_THAT(row(name), ::testing::Not(HasSubstr("href"))) << "the page shows earlier content";
  }
  EXPECT_THAT(row("b.h5"), HasSubstr(b_page));
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

}  // namespace
}  // namespace modebank::test
