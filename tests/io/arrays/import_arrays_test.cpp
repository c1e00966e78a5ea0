// Reads files of arrays as runs, through the interface of tables.
#include <cmath>

#include "io/arrays/array_reader.hpp"
#include "tests/io/arrays/mat_writer.hpp"
#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using test::MatWriter;
using test::row;
using ::testing::ElementsAre;

class ImportArrays : public test::ImportFixture {
 protected:
  ImportArrays() { options.states.clear(); }
};

TEST_F(ImportArrays, JoinStructsOfAMatlabFile) {
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    {
      MatWriter file(folder.path() / "log.mat", version);
      matvar_t* imu = MatWriter::structure(
          "imu", {"t", "wz"},
          {{MatWriter::matrix("t", {0, 0.5, 1, 1.5, 2}, 5), MatWriter::matrix("wz", {0, 1, 2, 3, 4}, 5)}});
      matvar_t* cmd = MatWriter::structure(
          "cmd", {"t", "v"}, {{MatWriter::matrix("t", {0, 1, 2}, 1), MatWriter::matrix("v", {10, 20, 30}, 1)}});
      file.write(MatWriter::structure("log", {"imu", "cmd"}, {{imu, cmd}}));
    }
    options.inputs = "log.mat";
    options.state = {"log.imu.wz"};
    options.input = {"log.cmd.v"};
    const ImportedData data = import();
    ASSERT_EQ(data.recording.runs.size(), 1U);
    EXPECT_EQ(data.recording.runs[0].state, row({0, 2, 4}));
    EXPECT_EQ(data.recording.runs[0].input, row({10, 20, 30}));
    options.time = {"log.imu.t"};
    EXPECT_EQ(import().recording.runs[0].state, row({0, 2, 4}))
        << "the inputs' times have the same name in their struct";
    options.time = {"t"};
    EXPECT_EQ(import().recording.runs[0].state, row({0, 2, 4}));
    options.time = DataOptions().time;
  }
}

TEST_F(ImportArrays, TakeTimesFromTheStructAbove) {
  {
    MatWriter file(folder.path() / "log.mat", MAT_FT_MAT5);
    matvar_t* imu = MatWriter::structure("imu", {"wz"}, {{MatWriter::matrix("wz", {0, 1, 2}, 3)}});
    file.write(
        MatWriter::structure("log", {"time", "u", "imu"},
                             {{MatWriter::matrix("time", {0, 1, 2}, 3), MatWriter::matrix("u", {5, 6, 7}, 3), imu}}));
  }
  const auto reader = open_mat_tables(folder.path() / "log.mat");
  ASSERT_EQ(reader->tables().size(), 1U);
  EXPECT_THAT(column_names(reader->tables()[0]), ElementsAre("log.time", "log.u", "log.imu.wz"));
  options.inputs = "log.mat";
  options.state = {"log.imu.wz"};
  options.input = {"log.u"};
  EXPECT_EQ(import().recording.runs[0].input, row({5, 6, 7}));
}

TEST_F(ImportArrays, TakeTsOfAStructForItsSampleTime) {
  options.inputs = "log.mat";
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    {
      MatWriter file(folder.path() / "log.mat", version);
      file.write(MatWriter::structure("z", {"y", "u", "Ts"},
                                      {{MatWriter::matrix("y", {0, 1, 2, 3}, 4),
                                        MatWriter::matrix("u", {5, 6, 7, 8}, 4), MatWriter::matrix("Ts", {0.25}, 1)}}));
    }
    options.state = {"z.y"};
    options.input = {"z.u"};
    EXPECT_EQ(import().recording.runs[0].time_s.transpose(), row({0, 0.25, 0.5, 0.75}));
    {
      MatWriter file(folder.path() / "log.mat", version);
      file.write(MatWriter::matrix("y", {0, 1, 2, 3}, 4));
      file.write(MatWriter::matrix("t", {0, 1, 2, 3}, 4));
      file.write(MatWriter::matrix("Ts", {0.25}, 1));
    }
    options.state = {"y"};
    options.input.clear();
    options.time = {"t"};
    EXPECT_EQ(import().recording.runs[0].time_s.transpose(), row({0, 1, 2, 3})) << "times stand beside it";
    options.time = DataOptions().time;
    {
      MatWriter file(folder.path() / "log.mat", version);
      file.write(MatWriter::matrix("y", {0, 1, 2, 3}, 4));
      file.write(MatWriter::matrix("Ts", {-1.0}, 1));
    }
    EXPECT_THAT(error<ConfigurationError>(), ::testing::HasSubstr("\"time\"")) << "no time runs backwards";
  }
}

/// The smallest and the largest whole number are stamps 584 years apart. Their difference overflows 64 bits.
TEST_F(ImportArrays, RefuseStampsFarApart) {
  for (const std::vector<std::int64_t>& stamps :
       {std::vector<std::int64_t>{INT64_MIN, 0, 1, 2}, {INT64_MIN + 1, 0, 1, INT64_MAX}, {0, 1, 2, INT64_MAX}}) {
    {
      MatWriter file(folder.path() / "log.mat", MAT_FT_MAT5);
      file.write(MatWriter::whole("t", stamps));
      file.write(MatWriter::matrix("x", {0, 1, 2, 3}, 4));
    }
    options.inputs = "log.mat";
    options.state = {"x"};
    options.input.clear();
    options.time = {"t"};
    EXPECT_THAT(error<DataError>(), ::testing::HasSubstr("log.mat"));
  }
}

TEST_F(ImportArrays, RefuseValuesThatMiss) {
  {
    MatWriter file(folder.path() / "log.mat", MAT_FT_MAT5);
    file.write(MatWriter::matrix("t", {0, 1, 2}, 3));
    file.write(MatWriter::matrix("x", {0, NAN, 2}, 3));
  }
  options.inputs = "log.mat";
  options.state = {"x"};
  options.input.clear();
  EXPECT_THAT(error<DataError>(), ::testing::HasSubstr("log.mat:2: column x: missing value"));
}

}  // namespace
}  // namespace modebank
