// States and inputs from several tables of one file, as in recordings. Also runs that are split into blocks.
#include <fmt/format.h>

#include <cmath>

#include "io/import/bring.hpp"
#include "io/import/open_table.hpp"
#include "io/import/read_columns.hpp"
#include "io/import/split.hpp"
#include "tests/io/import/import_fixture.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;
using test::row;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

FileStream stream(std::initializer_list<double> times, std::initializer_list<std::initializer_list<double>> values) {
  FileStream result;
  result.stream.time_s = row(times).transpose();
  result.stream.values.resize(static_cast<Index>(values.size()), result.stream.time_s.size());
  Index i = 0;
  for (const auto& channel : values) result.stream.values.row(i++) = row(channel);
  for (std::size_t k = 0; k < times.size(); ++k) result.line.push_back(k + 1);
  result.file = "f.bag";
  result.time_column = "/a.header.stamp";
  return result;
}

constexpr double unknown = 0.0;

TEST(BringTo, InterpolatesWithinTheSpanOfTheOther) {
  FileStream target = stream({0, 1, 2, 3, 4}, {{10, 11, 12, 13, 14}, {unknown, unknown, unknown, unknown, unknown}});
  const FileStream other = stream({0.5, 1.5, 2.5, 3.5}, {{unknown, unknown, unknown, unknown}, {5, 15, 25, 35}});
  bring_to(target, other, {1}, Bring::interpolated);
  EXPECT_EQ(target.stream.time_s.transpose(), row({1, 2, 3}));
  EXPECT_EQ(target.stream.values.row(0), row({11, 12, 13}));
  EXPECT_TRUE(near(target.stream.values.row(1), row({10, 20, 30}), 1e-12));
  EXPECT_THAT(target.line, ElementsAre(2, 3, 4));
}

TEST(BringTo, HoldsTheLastValue) {
  FileStream target = stream({0, 1, 2, 3, 4}, {{unknown, unknown, unknown, unknown, unknown}});
  bring_to(target, stream({0.5, 2, 4.5}, {{7, 8, 9}}), {0}, Bring::held);
  EXPECT_EQ(target.stream.values, row({7, 8, 8, 8}));
}

TEST(BringTo, AGapOfTheOtherIsUnknown) {
  FileStream target = stream({0, 1, 2, 30, 31}, {{unknown, unknown, unknown, unknown, unknown}});
  bring_to(target, stream({0, 1, 2, 3, 33}, {{1, 2, 3, 4, 5}}), {0}, Bring::interpolated);
  EXPECT_EQ(target.stream.values.leftCols(3), row({1, 2, 3}));
  EXPECT_TRUE(std::isnan(target.stream.values(0, 3)));
}

TEST(BringTo, NoOverlapIsAnError) {
  FileStream target = stream({0, 1}, {{unknown, unknown}});
  EXPECT_THAT(test::message_of<DataError>([&] {
                bring_to(target, stream({5, 6}, {{1, 2}}), {0}, Bring::held);
              }),
              HasSubstr("do not overlap in time"));
}

class ImportLabel : public test::ImportFixture {
 protected:
  ImportLabel() { options.label = "ground"; }
  static std::vector<std::string> words(const ImportedData& data, std::size_t run) {
    std::vector<std::string> result;
    for (const int label : data.labels->of_runs.at(run))
      result.push_back(label < 0 ? "?" : data.labels->names.at(static_cast<std::size_t>(label)));
    return result;
  }
};

TEST_F(ImportLabel, OfEveryRowAnotherIsNone) {
  std::string pro = "time,u,ground\n", imu = "time,x\n", few = pro;
  for (int k = 0; k < 100; ++k) {
    pro += fmt::format("{0},{0},{1}\n", k, 0.1 * k);
    few += fmt::format("{0},{0},{1}\n", k, k % 40);
    imu += fmt::format("{0},{0}\n", k);
  }
  write("imu_a.csv", imu);
  write("pro_a.csv", pro);
  options.train = options.test = {};
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("data.label = ground has 100 distinct values in 100 samples"));
  for (int k = 100; k < 400; ++k) few += fmt::format("{0},{0},{1}\n", k, k % 40);
  for (int k = 100; k < 400; ++k) imu += fmt::format("{0},{0}\n", k);
  write("imu_a.csv", imu);
  write("pro_a.csv", few);
  EXPECT_THAT(import().notes,
              ::testing::Contains(HasSubstr("40 distinct values in 400 samples; check that it is a label")));
}

TEST_F(ImportLabel, TheLastOneHoldsThroughGapsAndRates) {
  options.missing = Missing::gap;
  write("pro_1.csv", "time,u\n0,1\n1,2\n2,3\n3,4\n4,5\n5,6\n");
  write("imu_1.csv", "time,x,ground\n0,1,\n0.5,2,ice\n1.5,3,ice\n2,4,grit\n3,,grit\n4,6,\n5,7,7\n");
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("1.1", "1.2"));
  EXPECT_THAT(data.labels->names, ElementsAre("7", "grit", "ice"));
  EXPECT_THAT(words(data, 0), ElementsAre("?", "ice", "grit"));
  EXPECT_THAT(words(data, 1), ElementsAre("grit", "7"));
}

TEST_F(ImportLabel, OfTheInputsFileAndOfRunsInOneFile) {
  options.inputs = "all.csv";
  options.states.clear();
  options.run = "lap";
  write("all.csv", "lap,time,x,u,ground\na,0,1,1,ice\nb,0,1,1,grit\na,1,1,1,grit\nb,1,2,2,ice\n");
  const ImportedData data = import();
  EXPECT_THAT(words(data, 0), ElementsAre("ice", "grit"));
  EXPECT_THAT(words(data, 1), ElementsAre("grit", "ice"));
}

TEST_F(ImportLabel, MustBeThere) {
  write_run("1");
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("no column \"ground\""));
}

/// The first state and the input are in one topic. The second state is in another topic, at other times.
TEST(ImportTopics, AStateOfAnotherTopicIsBroughtToTheOthersTimes) {
  MODEBANK_NEEDS_SHARED_DATA();
  const auto imported = [](std::vector<std::string> states) {
    DataOptions options;
    options.root = (test::shared_data_dir() / "bags").string();
    options.inputs = "husky_outdoor_test1.bag";
    options.state = std::move(states);
    options.input = {"/husky_velocity_controller/odom.twist.twist.angular.z"};
    return import_data(options).recording.runs.at(0);
  };
  const std::string gyro = "/imu/data.angular_velocity.y";
  const Trajectory both = imported({"/husky_velocity_controller/odom.twist.twist.linear.x", gyro});
  const Trajectory alone = imported({gyro});  // the input and the state are in two topics
  ASSERT_GT(both.samples(), 3900);
  EXPECT_EQ(both.input, alone.input);
  EXPECT_TRUE(near(both.state.row(1), alone.state.row(0), 1e-12));
  EXPECT_NEAR(both.state.row(0).maxCoeff(), 1.0166, 1e-4) << "the speed, as the odometry says it";
}

class ImportSplit : public test::ImportFixture {
 protected:
  ImportSplit() {
    options.states.clear();
    options.inputs = "drive.csv";
    std::string content = "time,x,u\n";
    for (int k = 0; k <= 100; ++k) content += fmt::format("{},{},{}\n", 0.5 * k, k, 2 * k);
    write("drive.csv", content);
  }
};

TEST_F(ImportSplit, BlocksTrainInTurnWithAGapBetweenThem) {
  options.split.kind = SplitKind::blocks;
  options.split.blocks = 4;
  options.split.gap_samples = 5;
  const ImportedData data = import();
  EXPECT_THAT(names(data), ElementsAre("drive.b1", "drive.b2", "drive.b3", "drive.b4"));
  EXPECT_THAT(names(data, Role::train), ElementsAre("drive.b1", "drive.b3"));
  EXPECT_EQ(data.recording.runs[0].state(0, 0), 0);
  EXPECT_EQ(data.recording.runs[0].state(0, data.recording.runs[0].samples() - 1), 19) << "5 of 25 are dropped";
  EXPECT_EQ(data.recording.runs[1].state(0, 0), 25);
  EXPECT_EQ(data.recording.runs[1].time_s(0), 12.5);
  EXPECT_EQ(data.recording.runs[3].state(0, data.recording.runs[3].samples() - 1), 100) << "nothing follows the last";
  EXPECT_THAT(data.notes, testing::Contains(HasSubstr("split into 4 blocks")));
}

TEST(ReadColumns, LeaveOutANameThatComesTwice) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "log.csv";
  test::write_file(file, "time,x,spare,spare\n0,1,7,8\n1,2,9,10\n");
  const auto reader = open_table(file, {});
  const FileColumns read = read_columns(*reader, reader->tables(), choice_of(file.string(), reader->tables(), {}));
  EXPECT_EQ(std::get<std::vector<double>>(read.tables.at(0).at(1)), (std::vector<double>{1, 2}));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(read.tables.at(0).at(3)));
  EXPECT_THAT(read.notes, ElementsAre("column \"spare\" is left out, because it occurs 2 times"));
  EXPECT_THROW(choice_of(file.string(), reader->tables(), {"spare"}), ConfigurationError);
}

TEST_F(ImportSplit, TheLastPercentsAreHeldOut) {
  options.split.kind = SplitKind::last;
  options.split.last_percent = 30;
  options.split.gap_samples = 10;
  const ImportedData data = import();
  EXPECT_THAT(names(data, Role::train), ElementsAre("drive.b1"));
  EXPECT_THAT(names(data, Role::test), ElementsAre("drive.b2"));
  EXPECT_EQ(data.recording.runs[0].samples(), 60);
  EXPECT_EQ(data.recording.runs[1].samples(), 31);
  EXPECT_EQ(data.recording.runs[1].state(0, 0), 70);
}

TEST_F(ImportSplit, BlocksCanBeNamed) {
  options.split.kind = SplitKind::blocks;
  options.split.blocks = 3;
  options.test = {"drive.b1"};
  EXPECT_THAT(names(import(), Role::train), ElementsAre("drive.b2", "drive.b3"));
}

TEST_F(ImportSplit, BlocksShorterThanTheGapAreAnError) {
  options.split.kind = SplitKind::blocks;
  options.split.blocks = 20;
  options.split.gap_samples = 5;
  EXPECT_THAT(error<DataError>(), HasSubstr("dropped at its end"));
}

TEST(ProposedSplit, HasBlocksWhereEachHoldsWindows) {
  EXPECT_EQ(proposed_split(399, 26), "last 30 %");
  EXPECT_EQ(proposed_split(420, 26), "blocks 4");
  EXPECT_EQ(proposed_split(4000, 26), "blocks 10");
}

}  // namespace
}  // namespace modebank
