// Generated texts are valid for any name in a user's file.
#include "app/export/names.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "app/export/forms.hpp"
#include "app/text/csv_text.hpp"
#include "tests/app/export/exported.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::app::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Names that columns in users' files may have.
const std::vector<std::string>& hostile_names() {
  static const std::vector<std::string> names{"*/ int x; /*",
                                              "*$F/ int x; /$f*",
                                              "a\nb\r\n#error",
                                              "line \\",
                                              "?\?/",
                                              "\"; import os; os.system('x') #",
                                              "\"\"\"",
                                              "'''\\",
                                              "%{}{{}}%s$p$P$real",
                                              "=cmd|' /C calc'!A0",
                                              "+1",
                                              "-1",
                                              "@SUM(A1)",
                                              "\t=1",
                                              "\r=1",
                                              "a: b # c",
                                              "- &x *x !!python/object:os.system",
                                              "\xff\xfe\x00",
                                              "\xe2\x80\xa8line\xc2\x85",
                                              "while",
                                              "\\input{x} $ & % _ ^ ~",
                                              "yaw rate [\xc2\xb0/s]",
                                              "\x7f\x1b[31m",
                                              " "};
  return names;
}

TEST(Names, BecomeIdentifiersOfTheirOwn) {
  EXPECT_THAT(identifiers({"wz", "wz", "w z", "1st", "int", "", "\xc3\xa9", "_Bool"}),
              ElementsAre("wz", "wz_2", "w_z", "n1st", "int_2", "unnamed", "unnamed_2", "Bool"));
  std::vector<std::string> names = hostile_names();
  names.insert(names.end(), hostile_names().begin(), hostile_names().end());
  const std::vector<std::string> found = identifiers(names);
  EXPECT_EQ(std::set<std::string>(found.begin(), found.end()).size(), names.size());
  for (const std::string& name : found)
    EXPECT_TRUE(std::regex_match(name, std::regex("[A-Za-z_][A-Za-z0-9_]*"))) << name;
}

TEST(Names, StayWithinComments) {
  for (const std::string& name : hostile_names()) {
    const std::string comment = comment_text(name);
    EXPECT_EQ(comment.find_first_of("\n\r\t\\"), std::string::npos) << name;
    EXPECT_THAT(comment, Not(HasSubstr("*/"))) << name;
    EXPECT_THAT(comment, Not(HasSubstr("/*"))) << name;
  }
}

/// Python's CSV reader reads a table with hostile columns and texts. No cell may be a formula.
TEST(Names, AreNoFormulasInTables) {
  nlohmann::json table = {{"columns", nlohmann::json::array()}, {"value", {nlohmann::json::object()}}};
  for (const std::string& name : hostile_names()) {
    if (name.find('\xff') != std::string::npos) continue;
    table["columns"].push_back(name);
    table["value"][0][name] = name;
  }
  const modebank::test::TemporaryFolder folder;
  const std::string file = (folder.path() / "table.csv").string();
  modebank::test::write_file(file, csv_text(table, "/table"));
  const auto result = modebank::test::run_program(
      {"/usr/bin/python3", "-c",
       "import csv, json, sys; print(json.dumps(list(csv.reader(open(sys.argv[1], newline='', encoding='utf-8')))))",
       file});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json rows = nlohmann::json::parse(result.out);
  ASSERT_EQ(rows.size(), 2u);
  for (const nlohmann::json& row : rows) {
    ASSERT_EQ(row.size(), table["columns"].size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string cell = row[i].get<std::string>(), name = table["columns"][i].get<std::string>();
      const bool is_number = name == "+1" || name == "-1";
      EXPECT_EQ(std::string("=+-@\t\r").find(cell.front()) != std::string::npos, is_number) << cell;
      EXPECT_TRUE(cell == name || cell == "'" + name) << cell;
    }
  }
}

/// JSON is valid even if a text has bytes that are not UTF-8.
TEST(Names, StayWithinJson) {
  ExportedBank exported = as_exported(modebank::test::example_bank(1, 1, 1));
  for (const std::string& name : hostile_names()) {
    exported.states[0] = exported.inputs[0] = exported.measurements[0] = {name, name};
    exported.archive = exported.finding = exported.mode_names[0] = exported.parameter_names[0] = name;
    EXPECT_NO_THROW(nlohmann::json::parse(to_json(exported))) << name;
  }
}

TEST(Names, DoNotReachTheCompiler) {
  ExportedBank exported = as_exported(modebank::test::example_bank(2, 2, 2));
  const modebank::test::TemporaryFolder folder;
  for (const std::string& name : hostile_names()) {
    for (auto* channels : {&exported.states, &exported.inputs, &exported.recorded_inputs, &exported.measurements})
      for (Channel& channel : *channels) channel = {name, name};
    exported.archive = name;
    exported.mode_names.assign(2, name);
    exported.provenance.modebank_version = name;
    const CFiles files = to_c(exported, "auto");
    modebank::test::write_file(folder.path() / "auto.h", files.header);
    modebank::test::write_file(folder.path() / "auto.c", files.source);
    const std::string source = (folder.path() / "auto.c").string(), object = (folder.path() / "auto.o").string();
    for (const std::vector<std::string>& compiler :
         {std::vector<std::string>{"/usr/bin/cc", "-std=c99", "-Wconversion"},
          {"/usr/bin/g++", "-x", "c++", "-fsyntax-only", "-include", (folder.path() / "auto.h").string(),
           "/dev/null"}}) {
      std::vector<std::string> words = compiler;
      words.insert(words.end(), {"-pedantic", "-Wall", "-Wextra", "-Wtrigraphs", "-Werror"});
      if (compiler.size() == 3) words.insert(words.end(), {"-c", source, "-o", object});
      const auto result = modebank::test::run_program(words);
      EXPECT_EQ(result.status, 0) << name << "\n" << result.err;
    }
  }
}

}  // namespace
}  // namespace modebank::app::test
