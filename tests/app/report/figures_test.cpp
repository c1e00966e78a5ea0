#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/report/figures/figure.hpp"
#include "app/report/figures/palette.hpp"
#include "app/report/figures/shown_groups.hpp"
#include "app/report/page/run_sections.hpp"
#include "ident/base/distributions.hpp"
#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

#define MODEBANK_NEEDS_GNUPLOT() \
  MODEBANK_NEEDS(has_program("gnuplot"), "gnuplot is absent: apt-get install gnuplot-nox")

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// The rows of one block of a figure's data.
std::vector<std::vector<double>> block(const std::string& data, int number) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(data);
  int empty = 0, current = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() && ++empty % 2 == 0) ++current;
    if (line.empty() || line[0] == '#' || current != number) continue;
    std::istringstream words(line);
    rows.emplace_back();
    for (std::string word; words >> word;) rows.back().push_back(word == "NaN" ? std::nan("") : std::stod(word));
  }
  return rows;
}

class Figures : public CliTest {
 protected:
  std::set<std::string> drawn() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(file("figures")))
      names.insert(entry.path().filename().string());
    return names;
  }
  /// Into a folder named as seen from the current one.
  ProgramResult report(std::vector<std::string> options = {}) const {
    const std::string folder = std::filesystem::relative(file("figures")).string();
    options.insert(options.begin(), {"report", archive(), "--report.figures", folder});
    return modebank(options);
  }
};

TEST(Figure, TextsAreQuotedAndEmptyBlocksKeepTheirNumber) {
  app::report::Figure figure("name", "plot x\n");
  figure.set("label", std::string("it's `date` \"$x\"\nnext"));
  figure.set("K", Eigen::Index{3});
  figure.add_block("none", {"a", "b"}, Eigen::MatrixXd(0, 2));
  figure.add_block("one", {"a", "b"}, (Eigen::MatrixXd(1, 2) << 1, 0.1).finished());
  EXPECT_NE(figure.script().find("label = 'it\u2019s `date` \"$x\" next'\nK = 3\n"), std::string::npos)
      << figure.script();
  EXPECT_EQ(figure.data(), "# none\n# a | b\nNaN NaN\n\n\n# one\n# a | b\n1 0.1\n");
}

TEST_F(Figures, AreDrawnFromTheArchivesNumbers) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run().status, 0);
  const ProgramResult result = report({"--report.sources", "true", "--report.png", "true"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name : {"local_models", "selection", "estimates", "prediction", "nis", "pit", "coverage"})
    for (const char* kind : {".svg", ".pdf", ".png", ".tex", ".gp", ".dat"})
      EXPECT_TRUE(drawn().count(std::string(name) + kind)) << name << kind;
  const Archive archived = read_archive(archive());
  const RunEvaluation& evaluation = archived.evaluations.at(0).runs.at(1);  // bank, the held-out run
  ASSERT_EQ(archived.recording->runs[1].role, Role::test);
  const auto nis = block(text_of(file("figures/nis.dat")), 0);
  const auto band = block(text_of(file("figures/prediction.dat")), 0);
  ASSERT_EQ(nis.size(), 80u);
  ASSERT_EQ(band.size(), 80u);
  for (std::size_t k = 1; k < nis.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(nis[k][2], evaluation.nis(i), 1e-8 * evaluation.nis(i));
    const double sd = std::sqrt(evaluation.innovation_covariance(0, i));
    EXPECT_NEAR(band[k][3] - band[k][2], 2 * 1.959963984540054 * sd, 1e-7);
    EXPECT_EQ(std::isnan(band[k][4]), std::abs(evaluation.innovation(0, i)) <= 1.959963984540054 * sd);
  }
  const auto sums = block(text_of(file("figures/nis.dat")), 1);
  for (const auto& row : sums) EXPECT_NEAR(row.back(), 1.0, 1e-8);
  const auto coverage = block(text_of(file("figures/coverage.dat")), 0);
  ASSERT_EQ(coverage.size(), 5u);  // four competitors and the bank
  for (const SummaryRow& row : archived.summary)
    if (row.filter == "bank" && row.run == "*") {
      EXPECT_NEAR(coverage.back()[row.role == Role::train ? 1 : 3], 100 * row.nis_above, 1e-6);
    }
}

TEST_F(Figures, HostileNamesAreText) {
  MODEBANK_NEEDS_GNUPLOT();
  for (const char* name : {"run_00.csv", "run_01.csv"}) {
    std::string text = csv_run(80, 3);
    text.replace(text.find("wz"), 2, "<script>'w{z}_`date`&\xC3\xBC</script>");
    write(name, text);
  }
  ASSERT_EQ(run({"--data.state", "<script>'w{z}_`date`&\xC3\xBC</script>"}).status, 0);
  const ProgramResult result = report();
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string svg = text_of(file("figures/prediction.svg"));
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
  // gnuplot misreads a quote at the beginning of a string: an apostrophe stands in for it.
  EXPECT_NE(svg.find("&lt;script>\u2019w{z}_`date`&amp;\xC3\xBC&lt;/script>"), std::string::npos);
}

TEST_F(Figures, OneModeAndNothingHeldOut) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run({"--mixture.components", "1", "--data.train", "00,01"}).status, 0);
  const ProgramResult result = report();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("left out: selection"), std::string::npos) << result.out;
  EXPECT_TRUE(drawn().count("coverage.svg"));
}

TEST_F(Figures, AnArchiveWithoutABankSaysWhatIsMissing) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(modebank({"identify", config(), "--archive.output", archive(), "--data.root", file("").string()}).status,
            0);
  const ProgramResult result = report();
  EXPECT_NE(result.out.find("no mixture"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("no evaluation"), std::string::npos) << result.out;
}

/// A font file in a PDF is a stream that a descriptor names.
TEST_F(Figures, FontsAreEmbeddedInThePdf) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run().status, 0);
  ASSERT_EQ(report().status, 0);
  EXPECT_NE(text_of(file("figures/pit.pdf")).find("/FontFile"), std::string::npos);
  const std::string snippet = text_of(file("figures/pit.tex"));
  EXPECT_NE(snippet.find("\\includegraphics[width=\\columnwidth]{pit}"), std::string::npos) << snippet;
  EXPECT_NE(snippet.find("95 \\% of its bars"), std::string::npos) << snippet;
}

TEST_F(Figures, OneThatFailsIsNamedAndDoesNotLoseTheOthers) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run().status, 0);
  std::filesystem::create_directory(file("bin"));
  write("bin/gnuplot",
        "#!/bin/sh\nfor last; do :; done\n[ \"$last\" != nis.gp ] || { echo no ink left >&2; exit 1; }\n"
        "PATH=${PATH#*:} exec gnuplot \"$@\"\n");
  std::filesystem::permissions(file("bin/gnuplot"), std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (file("bin").string() + ":" + path).c_str(), 1);
  const ProgramResult result = report({"-o", file("page.html").string(), "--json"});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("1 of "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("nis.svg: gnuplot could not draw it: no ink left"), std::string::npos) << result.err;
  EXPECT_TRUE(drawn().count("pit.pdf") && drawn().count("transition.svg") + drawn().count("coverage.svg") > 0);
  EXPECT_FALSE(drawn().count("nis.svg"));
  EXPECT_TRUE(std::filesystem::exists(file("page.html")));
  const nlohmann::json said = nlohmann::json::parse(result.out);
  EXPECT_EQ(said.at("status"), 1);
  EXPECT_NE(said.at("error").get<std::string>().find("1 of "), std::string::npos);
  const auto written = said.at("written").get<std::set<std::string>>();
  EXPECT_TRUE(written.count(file("page.html").string()));
  EXPECT_EQ(written.size(), drawn().size() + 1) << result.out;
}

TEST_F(Figures, ReplaceFiguresAlone) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run().status, 0);
  std::filesystem::create_directory(file("figures"));
  const std::vector<std::string> all{"--report.sources", "true", "--report.png", "true", "-o", file("p.html").string()};
  for (const char* name :
       {"nis.pdf", "nis.tex", "selection.svg", "pit.png", "coverage.gp", "coverage.dat", "style.gp"}) {
    const std::filesystem::path mine = file("figures") / name;
    write(std::string("figures/") + name, "mine");
    const ProgramResult result = report(all);
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find(std::string(name) + " is there and not replaced"), std::string::npos) << result.err;
    EXPECT_EQ(text_of(mine), "mine");
    EXPECT_EQ(drawn(), std::set<std::string>{name});
    EXPECT_FALSE(std::filesystem::exists(file("p.html"))) << "refused before the page is written";
    std::filesystem::remove(mine);
  }
  for (int time = 0; time < 2; ++time) EXPECT_EQ(report(all).status, 0);
  std::filesystem::remove(file("figures/nis.svg"));
  std::filesystem::create_symlink(archive(), file("figures/nis.svg"));
  EXPECT_NE(report().err.find("nis.svg is read by this command"), std::string::npos);
}

TEST_F(Figures, TheNextOnesTakeAwayWhatAKilledProcessLeft) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run().status, 0);
  std::filesystem::create_directory(file("bin"));
  write("bin/gnuplot", "#!/bin/sh\nkill -9 $PPID\n");
  std::filesystem::permissions(file("bin/gnuplot"), std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (file("bin").string() + ":" + path).c_str(), 1);
  report();
  setenv("PATH", path.c_str(), 1);
  const auto hidden = [&] {
    const std::set<std::string> names = drawn();
    return std::count_if(names.begin(), names.end(), [](const std::string& name) { return name[0] == '.'; });
  };
  ASSERT_EQ(hidden(), 1);
  for (const std::string& name : drawn())
    if (name[0] == '.') {
      const std::filesystem::path left = file("figures/" + name);
      std::filesystem::last_write_time(left, std::filesystem::last_write_time(left) - std::chrono::hours(48));
    }
  ASSERT_EQ(report().status, 0);
  EXPECT_EQ(hidden(), 0);
}

/// A page colours modes by their place in this order, figures by their place among those that are shown.
TEST_F(Figures, ModesHaveThePagesOrderAndColours) {
  ASSERT_EQ(run({"--mixture.components", "12", "--mixture.restarts", "1", "--bank.refine", "none"}).status, 0);
  const Archive archived = read_archive(archive());
  const app::report::ShownGroups modes = app::report::shown_modes(archived);
  const nlohmann::json bank = app::report::bank_section(archived);
  ASSERT_GT(modes.shown.size(), 1u);
  EXPECT_EQ(static_cast<Index>(modes.shown.size()), bank["told"].get<Index>());
  std::vector<Index> all = modes.shown;
  all.insert(all.end(), modes.others.begin(), modes.others.end());
  EXPECT_EQ(all, bank["order"].get<std::vector<Index>>());
  EXPECT_GE(app::report::palette().modes.size(), modes.shown.size());
}

/// The largest keep their order and their colours; the others are one group.
TEST(ShownGroups, AreTheLargestOfMany) {
  Eigen::VectorXd sizes = Eigen::VectorXd::LinSpaced(55, 0.0, 1.0);
  sizes(3) = 2.0;
  const app::report::ShownGroups groups = app::report::shown_groups(sizes);
  EXPECT_EQ(groups.shown, (std::vector<Eigen::Index>{3, 48, 49, 50, 51, 52, 53, 54}));
  EXPECT_EQ(groups.others.size(), 47u);
  EXPECT_EQ(groups.others_title(), "47 others");
  EXPECT_FALSE(app::report::shown_groups(sizes.head(8)).any_others());
}

TEST_F(Figures, OfFiftyComponentsAreDrawn) {
  MODEBANK_NEEDS_GNUPLOT();
  ASSERT_EQ(run({"--mixture.components", "50", "--mixture.restarts", "1", "--bank.refine", "none"}).status, 0);
  const ProgramResult result = report();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(text_of(file("figures/local_models.svg")).find("42 others, none"), std::string::npos);
}

TEST_F(Figures, AMissingGnuplotIsNamedAndNothingIsWritten) {
  ASSERT_EQ(run().status, 0);
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const ProgramResult result = report();
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("gnuplot-nox"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(file("figures")));
}

TEST_F(Figures, AnUnknownRunAndABrokenArchiveWriteNothing) {
  ASSERT_EQ(run().status, 0);
  const ProgramResult unknown = report({"--report.run", "17"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("00, 01"), std::string::npos) << unknown.err;
  std::string bytes = text_of(archive());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write("out.h5", bytes);
  EXPECT_EQ(report().status, 1);
  EXPECT_FALSE(std::filesystem::exists(file("figures")));
}

}  // namespace
}  // namespace modebank::test
