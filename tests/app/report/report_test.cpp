#include <gtest/gtest.h>
#include <zlib.h>

#include <boost/algorithm/string.hpp>
#include <nlohmann/json.hpp>
#include <regex>

#include "app/report/page/html_page.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_page.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/series.hpp"
#include "app/report/page/unit_text.hpp"
#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using app::report::PageArrays;
using nlohmann::json;

TEST(ReportNumbers, AreWrittenAsPeopleWriteThem) {
  using namespace app::report;
  EXPECT_EQ(estimate_text(-0.59702, 0.00281), "-0.5970 ± 0.0028");
  EXPECT_EQ(estimate_text(12.3456, 4.2), "12.3 ± 4.2");
  EXPECT_EQ(estimate_text(1234567, 42000), "1.235e+06 ± 4.2e+04");
  EXPECT_EQ(estimate_text(0.5, std::nan("")), "0.5");
  EXPECT_EQ(number_text(std::nan("")), "–");
  EXPECT_EQ(percent_text(0.02496), "2.50 %");
  EXPECT_EQ(count_text(1234567), "1\u202f234\u202f567");
  EXPECT_EQ(count_text(-123), "-123");
  EXPECT_EQ(number(1.0 / 3.0)["v"].get<double>(), 1.0 / 3.0);  // the member v is the exact value
  EXPECT_TRUE(number(std::nan(""))["v"].is_null());
}

/// Decodes a stored array with zlib and with code of this test.
std::string unpacked(const PageArrays& arrays, const json& place, std::size_t width) {
  static const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string& text = arrays.stored().at(std::stoul(place.at("id").get<std::string>().substr(1)));
  std::string deflated;
  unsigned bits = 0, held = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    bits = bits << 6 | static_cast<unsigned>(alphabet.find(letter));
    if ((held += 6) >= 8) deflated += static_cast<char>(bits >> (held -= 8) & 255u);
  }
  const auto count = place.at("size").get<std::size_t>();
  std::string planes(count * width, '\0'), bytes = planes;
  uLongf size = planes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(planes.data()), &size, reinterpret_cast<const Bytef*>(deflated.data()),
                       deflated.size()),
            Z_OK);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t b = 0; b < width; ++b) bytes[i * width + b] = planes[b * count + i];
  return bytes;
}

template <class T>
std::vector<T> values_of(const PageArrays& arrays, const json& place) {
  const std::string bytes = unpacked(arrays, place, sizeof(T));
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TEST(ReportArrays, ComeBackAsTheyWentIn) {
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(1001, -3.7, 1e5);
  PageArrays arrays;
  const json exact = arrays.add_exact(values), rounded = arrays.add(values), shares = arrays.add_shares(values / 1e5);
  const auto doubles = values_of<double>(arrays, exact);
  EXPECT_TRUE(std::equal(doubles.begin(), doubles.end(), values.begin(), values.end()));
  const auto floats = values_of<float>(arrays, rounded);
  for (std::size_t i = 0; i < floats.size(); ++i)
    EXPECT_EQ(floats[i], static_cast<float>(values(static_cast<Index>(i))));
  const auto steps = values_of<std::uint16_t>(arrays, shares);
  EXPECT_EQ(steps.front(), 0);  // a value below 0 becomes 0
  EXPECT_EQ(steps.back(), 65534);
  EXPECT_NEAR(steps[500] / 65534.0, values(500) / 1e5, 1e-5);
  const auto most = [&](std::size_t width) { return PageArrays::most_bytes(values.size(), width); };
  EXPECT_GE(most(8) + most(4) + most(2), arrays.bytes());  // most() is an upper bound
}

TEST(ReportSeries, LevelsHoldTheExtremesOfEverySample) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(100'000);
  values(54'321) = 7.0;
  PageArrays arrays;
  const json signal = app::report::series(arrays, values, 1);
  EXPECT_EQ(values_of<float>(arrays, signal["raw"])[54'321], 7.0f);
  ASSERT_EQ(signal["levels"].size(), 1u);
  const auto bucket = signal["levels"][0]["bucket"].get<std::size_t>();
  const auto high = values_of<float>(arrays, signal["levels"][0]["high"]);
  EXPECT_EQ(high.at(54'321 / bucket), 7.0f);
  EXPECT_EQ(std::count(high.begin(), high.end(), 7.0f), 1);
  const json coarse = app::report::series(arrays, values, 64);
  EXPECT_TRUE(coarse["raw"].is_null());
  EXPECT_EQ(coarse["levels"][0]["bucket"], 64);
}

TEST(ReportRuns, OfThousandsTheFirstHundredOfEachRoleAreDrawn) {
  Recording recording;
  recording.runs.resize(10000);
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    recording.runs[i].role = i % 4 == 0 ? Role::test : Role::train;
  const std::vector<std::size_t> drawn = app::report::drawn_runs(recording);
  ASSERT_EQ(drawn.size(), 200u);
  EXPECT_TRUE(std::is_sorted(drawn.begin(), drawn.end()));
  EXPECT_EQ(drawn.back(), 4u * 99u);  // the hundredth held-out run is the last
  recording.runs.resize(40);
  EXPECT_EQ(app::report::drawn_runs(recording).size(), 40u);
}

TEST(ReportPage, NamesCannotLeaveTheirPlace) {
  app::report::Page page;
  page.title = "</title><script>alert(1)</script>";
  page.data = {{"name", "</script><script>alert(2)</script><!-- \xff"}, {"ok", "{{css}} é"}};
  page.script = "done();";
  const std::string html = html_of(page);
  EXPECT_EQ(html.find("alert(1)</script>"), std::string::npos);
  EXPECT_EQ(html.find("</script><script>alert(2)"), std::string::npos);
  EXPECT_NE(html.find("&lt;/title&gt;"), std::string::npos);
  const std::string open = "<script type=\"application/json\" id=\"page-data\">";
  const std::size_t from = html.find(open) + open.size();
  const json data = json::parse(html.substr(from, html.find("</script>", from) - from));
  EXPECT_EQ(data["ok"], "{{css}} é");  // a text in the data is not replaced, even if it looks like a part of the
                                       // template
  EXPECT_EQ(data["name"].get<std::string>().substr(0, 35), "</script><script>alert(2)</script><");
}

class Report : public CliTest {
 protected:
  std::string page() const { return file("page.html").string(); }
  json data_of_page() const {
    const std::string html = read_file(page()), open = "id=\"page-data\">";
    const std::size_t from = html.find(open) + open.size();
    return json::parse(html.substr(from, html.find("</script>", from) - from));
  }
};

TEST_F(Report, PageHoldsTheArchivesNumbersAndReachesNowhere) {
  ASSERT_EQ(run().status, 0);
  const ProgramResult result = modebank({"report", archive(), "-o", page()});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("MB"), std::string::npos);
  const Archive stored = read_archive(archive());
  const json data = data_of_page();
  EXPECT_EQ(data["origin"]["config"], stored.config);
  ASSERT_EQ(data["filter"]["scores"].size(), stored.summary.size());
  for (std::size_t i = 0; i < stored.summary.size(); ++i)
    EXPECT_EQ(data["filter"]["scores"][i]["log_score"]["v"].get<double>(), stored.summary[i].log_score);
  for (std::size_t k = 0; k < stored.bank->modes.size(); ++k)
    EXPECT_EQ(data["bank"]["modes"][k]["parameters"][0]["v"].get<double>(),
              stored.bank->theta(static_cast<Index>(k))(0));
  EXPECT_EQ(data["data"]["runs"].size(), stored.recording->runs.size());
  const std::string html = read_file(page());
  EXPECT_FALSE(std::regex_search(html.substr(0, 4000), std::regex("(src|href)=\"(https?:)?//")));
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);  // the policy makes the browser block the network
  EXPECT_LE(html.size(), 64e6);
}

TEST_F(Report, IsTheSameOfRunsThatStayInTheFile) {
  ASSERT_EQ(run({"--filter.simulate", "10"}).status, 0);
  const Archive by_runs = read_archive(archive(), Evaluations::in_file);
  ASSERT_TRUE(by_runs.evaluations.front().in_file && !by_runs.evaluations.front().free_runs.empty());
  app::ReportConfig options;
  for (options.size_mb = 64.0; options.size_mb >= 8.0; options.size_mb /= 8.0)
    EXPECT_TRUE(html_of(app::report::run_page(by_runs, "a.h5", options)) ==
                html_of(app::report::run_page(read_archive(archive()), "a.h5", options)));
}

TEST_F(Report, EarlierStagesAlone) {
  for (const char* stage : {"windows", "mixture"}) {
    ASSERT_EQ(modebank({"run", config(), "--until", stage, "--archive.output", archive()}).status, 0) << stage;
    ASSERT_EQ(modebank({"report", archive(), "-o", page()}).status, 0) << stage;
    EXPECT_TRUE(data_of_page()["filter"].is_null());
    EXPECT_TRUE(data_of_page()["bank"].is_null());
    EXPECT_FALSE(data_of_page()["windows"].is_null());
  }
}

TEST_F(Report, WhatIsNoWholeArchiveLeavesNothingBehind) {
  ASSERT_EQ(run().status, 0);
  const std::string whole = read_file(archive());
  write("half.h5", whole.substr(0, whole.size() / 2));
  write("foreign.h5", "no archive at all");
  std::string changed = whole;
  changed[whole.size() - 100] = static_cast<char>(changed[whole.size() - 100] ^ 1);
  write("changed.h5", changed);
  for (const char* name : {"half.h5", "foreign.h5", "changed.h5"}) {
    const ProgramResult result = modebank({"report", file(name).string(), "-o", page()});
    EXPECT_EQ(result.status, 1) << name;
    EXPECT_NE(result.err.find(name), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(page())) << name;
  }
  EXPECT_EQ(modebank({"report", file("none.h5").string(), "-o", page()}).status, 2);
  EXPECT_EQ(modebank({"report", archive(), "-o", archive()}).status, 2);  // a page must not replace the archive
  EXPECT_EQ(read_file(archive()), whole);
  EXPECT_EQ(modebank({"report", archive(), "-o", file("no/folder.html").string()}).status, 2);
  EXPECT_EQ(modebank({"report"}).status, 2);
}

}  // namespace
}  // namespace modebank::test
