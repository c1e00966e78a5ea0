#include <fstream>

#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

/// Each case has one fault, and the message that a user must get.
class BadInput : public CliTest {
 protected:
  void expect(const ProgramResult& result, int status, const std::vector<std::string>& message) const {
    EXPECT_EQ(result.status, status) << result.err;
    for (const std::string& part : message)
      EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(left_behind(), std::vector<std::string>{}) << "something was written";
  }
  void replace_line(const std::string& name, int line, const std::string& text) const {
    std::ifstream in(file(name));
    std::string all, one;
    for (int i = 1; std::getline(in, one); ++i) all += (i == line ? text : one) + "\n";
    in.close();
    write(name, all);
  }
};

TEST_F(BadInput, MissingDataFile) { expect(run({"--data.inputs", "nothing_*.csv"}), 2, {"nothing_*.csv"}); }
TEST_F(BadInput, MissingStatesFile) { expect(run({"--data.states", "imu_*.csv"}), 2, {"imu_00.csv", "run_00.csv"}); }
TEST_F(BadInput, MissingConfigFile) { expect(modebank({"run", file("none.ini").string()}), 2, {"none.ini"}); }
TEST_F(BadInput, EmptyFile) {
  write("run_01.csv", "");
  expect(run(), 2, {"run_01.csv", "empty"});
}
TEST_F(BadInput, HeaderOnly) {
  write("run_01.csv", "time,wz,left,right\n");
  expect(run(), 1, {"run_01.csv"});
}
TEST_F(BadInput, UnknownColumn) { expect(run({"--data.state", "wzz"}), 2, {"wzz", "time, wz, left, right"}); }
TEST_F(BadInput, UnknownRunName) { expect(run({"--data.train", "00, 07"}), 2, {"07", "00", "01"}); }
TEST_F(BadInput, TextInANumber) {
  replace_line("run_01.csv", 5, "0.3,abc,0,0");
  expect(run(), 1, {"run_01.csv", "5", "wz", "abc"});
}
TEST_F(BadInput, NaN) {
  replace_line("run_01.csv", 5, "0.3,nan,0,0");
  expect(run(), 1, {"run_01.csv", "5", "wz"});
}
TEST_F(BadInput, EmptyField) {
  replace_line("run_01.csv", 5, "0.3,,0,0");
  expect(run(), 1, {"run_01.csv", "5", "wz"});
}
TEST_F(BadInput, TimeGoingBackwards) {
  replace_line("run_01.csv", 6, "0.1,0,0,0");
  expect(run(), 1, {"run_01.csv", "6", "time"});
}
TEST_F(BadInput, TwoSamples) {
  write("run_00.csv", csv_run(2, 1));
  write("run_01.csv", csv_run(2, 1));
  expect(run(), 1, {"25"});
}
TEST_F(BadInput, FewerSamplesThanAWindow) {
  write("run_00.csv", csv_run(25, 1));
  expect(run(), 1, {"25", "24"});
}
TEST_F(BadInput, UnknownKeyNamesLineAndNearest) {
  write("test.ini", std::string(config_text()) + "[window]\nlenght = 20\n");
  expect(run(), 2, {"test.ini:10", "window.lenght", "window.length"});
}
TEST_F(BadInput, UnknownOptionNamesNearest) {
  expect(run({"--window.lenght", "20"}), 2, {"window.lenght", "window.length"});
}
TEST_F(BadInput, AbbreviatedKeyInFile) {
  write("test.ini", std::string(config_text()) + "[window]\nlen = 20\n");
  expect(run(), 2, {"test.ini:10", "window.len", "window.length"});
}
TEST_F(BadInput, AbbreviatedOption) { expect(run({"--window.len", "20"}), 2, {"window.len", "window.length"}); }
TEST_F(BadInput, ValueOutOfRange) {
  expect(run({"--bank.stay", "1.5"}), 2, {"bank.stay", "1.5", "above 0 and at most 1"});
}
TEST_F(BadInput, TextForANumber) { expect(run({"--window.length", "2x"}), 2, {"window.length", "2x"}); }
TEST_F(BadInput, WordThatIsNone) { expect(run({"--window.loss", "hubert"}), 2, {"window.loss", "hubert", "huber"}); }
TEST_F(BadInput, EmptyBoolean) {
  write("test.ini", std::string(config_text()) + "[window]\nintercept =\n");
  expect(run(), 2, {"test.ini:10", "window.intercept", "true | false"});
}
TEST_F(BadInput, KeySetTwice) {
  write("test.ini", std::string(config_text()) + "[mixture]\ncomponents = 3\n");
  expect(run(), 2, {"test.ini:10", "mixture.components", "8"});
}
TEST_F(BadInput, LineThatIsNoKey) {
  write("test.ini", std::string(config_text()) + "what is this\n");
  expect(run(), 2, {"test.ini:9", "what is this"});
}
TEST_F(BadInput, ValueWithACommentSign) {
  expect(run({"--data.inputs", "a#b_*.csv"}), 2, {"data.inputs", "#", "comment"});
}
TEST_F(BadInput, ErrorsOfASandwichCovariance) {
  expect(run({"--mixture.error_aware", "true", "--window.covariance", "sandwich"}), 2,
         {"mixture.error_aware", "window.covariance = model"});
}
TEST_F(BadInput, MoreComponentsThanWindows) { expect(run({"--mixture.components", "500..501"}), 1, {"500", "55"}); }
TEST_F(BadInput, OutputFolderMissing) { expect(run({"--archive.output", file("none/out.h5").string()}), 2, {"none"}); }
TEST_F(BadInput, OutputFolderNotWritable) { expect(run({"--archive.output", "/proc/out.h5"}), 2, {"/proc"}); }
TEST_F(BadInput, OutputThatTheRunReads) {
  expect(run({"--archive.output", config()}), 2, {"archive.output", "test.ini"});
  expect(run({"--archive.output", file("run_01.csv").string()}), 2, {"archive.output", "run_01.csv"});
}
TEST_F(BadInput, CommentThatTouchesAValue) {
  write("test.ini", std::string(config_text()) + "[window]\nloss = hub#er\n");
  expect(run(), 2, {"test.ini:10", "window.loss", "# starts a comment"});
  write("test.ini", std::string("[data]\ninputs = run#_*.csv\nstate = wz\ninput = left, right\n"));
  expect(run(), 2, {"test.ini:2", "data.inputs is cut to 'run'", "# starts a comment"});
}
TEST_F(BadInput, UnknownCommand) { expect(modebank({"rnu", config()}), 2, {"rnu", "run"}); }
TEST_F(BadInput, NoCommand) { expect(modebank({}), 2, {"modebank help"}); }

/// Unreadable archives.
class BadArchive : public BadInput {
 protected:
  void expect_refused(const std::string& content, int status, const std::string& message) const {
    write("run_x.h5", content);
    for (const char* command : {"show", "verify"}) {
      const ProgramResult result = modebank({command, file("run_x.h5").string()});
      EXPECT_EQ(result.status, status) << command << ": " << result.out << result.err;
      const std::string said = result.out + result.err;
      EXPECT_NE(said.find("run_x.h5"), std::string::npos) << said;
      EXPECT_NE(said.find(message), std::string::npos) << said;
    }
  }
  std::string good_archive() const {
    EXPECT_EQ(run().status, 0);
    std::ifstream in(archive(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(BadArchive, Foreign) { expect_refused("this is no HDF5 file", 1, "not"); }
TEST_F(BadArchive, Truncated) {
  const std::string good = good_archive();
  expect_refused(good.substr(0, good.size() / 2), 1, "run_x.h5");
}
TEST_F(BadArchive, Missing) {
  EXPECT_EQ(modebank({"show", file("none.h5").string()}).status, 2);
  EXPECT_EQ(modebank({"evaluate", config(), "--archive.bank", file("none.h5").string()}).status, 2);
}
TEST_F(BadArchive, OneFlippedByteIsFound) {
  std::string content = good_archive();
  EXPECT_EQ(modebank({"verify", archive()}).status, 0);
  content[content.size() / 2] = static_cast<char>(content[content.size() / 2] ^ 1);
  write("run_x.h5", content);
  const ProgramResult result = modebank({"verify", file("run_x.h5").string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("SHA-256"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace modebank::test
