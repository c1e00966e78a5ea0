// Reads files of h5py as runs. tests/io/arrays/h5py_files.py contains their values.
#include <cstdlib>

#include "io/arrays/array_reader.hpp"
#include "io/import/read_columns.hpp"
#include "tests/io/import/import_fixture.hpp"

namespace modebank {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

class H5pyFiles : public test::ImportFixture {
 protected:
  void SetUp() override {
    MODEBANK_NEEDS(test::has_python_modules("h5py"), "h5py is absent: apt-get install python3-h5py");
    ASSERT_EQ(python("'" + (test::golden_dir().parent_path().parent_path() / "io/arrays/h5py_files.py").string() +
                     "' '" + folder.path().string() + "'"),
              0);
    options.states.clear();
    options.state = {"wz"};
    options.input = {"a"};
  }

  static int python(const std::string& arguments) { return std::system(("/usr/bin/python3 " + arguments).c_str()); }

  /// Reads a file and expects its 20 samples.
  ImportedData expect_samples(const std::string& name) {
    options.inputs = name;
    ImportedData data = import();
    const Trajectory& run = data.recording.runs.at(0);
    EXPECT_EQ(run.samples(), 20) << name;
    for (Index k = 0; k < run.samples(); ++k) {
      EXPECT_EQ(run.time_s(k), static_cast<double>(k) / 4) << name;
      EXPECT_EQ(run.state(0, k), static_cast<double>(k)) << name;
      EXPECT_EQ(run.input(0, k), 2.0 * static_cast<double>(k)) << name;
    }
    return data;
  }
};

TEST_F(H5pyFiles, MayHaveAUserBlockOfAnyPowerOfTwo) {
  for (const char* name : {"userblock_512.h5", "userblock_4096.h5", "userblock_65536.h5"}) expect_samples(name);
}

TEST_F(H5pyFiles, MayHaveCompoundsInCompounds) {
  options.state = {"imu.wz"};
  options.input = {"cmd.wheel.a"};
  expect_samples("nested.h5");
  options.label = "imu.name";
  const auto labels = import().labels;
  ASSERT_TRUE(labels);
  const auto reader = open_hdf5_tables(folder.path() / "nested.h5");
  EXPECT_EQ(column_names(reader->tables().at(0)),
            (std::vector<std::string>{"time", "imu.wz", "imu.name", "cmd.wheel.a"}));
}

TEST_F(H5pyFiles, MayStillBeWritten) { expect_samples("swmr.h5"); }

TEST_F(H5pyFiles, MayHaveADatasetBesideThatWasNeverWritten) {
  expect_samples("spare.h5");
  const auto reader = open_hdf5_tables(folder.path() / "spare.h5");
  EXPECT_THAT(reader->left_out(), Contains(HasSubstr("spare is left out: its 1000000000 values were never written")));
  const auto all = read_columns(*reader, reader->tables(), [](const TableInfo&, const ColumnInfo&) { return true; });
  EXPECT_EQ(all.tables.size(), 1U);
  options.state = {"spare"};
  EXPECT_THAT(error<ConfigurationError>(), HasSubstr("\"spare\": its 1000000000 values were never written"));
}

TEST_F(H5pyFiles, RepeatTheFillValueWhereTheyWereNeverWritten) {
  options.inputs = "zeros.h5";
  EXPECT_THAT(error<DataError>(),
              AllOf(HasSubstr("zeros.h5:21: column time: time goes backwards or repeats: 0 after 4.75"),
                    HasSubstr("rows 21 to 40 were never written")));
  options.disorder = Disorder::sort;
  EXPECT_THAT(expect_samples("zeros.h5").notes,
              Contains(HasSubstr("rows 21 to 40 of wz, a, time were never written, so they read as the file's fill")));
}

TEST_F(H5pyFiles, LackValuesWhereNaNIsTheFillValue) {
  options.inputs = "nans.h5";
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("nans.h5:21: column wz: missing value (nan)"),
                                        HasSubstr("rows 21 to 40 were never written")));
  options.missing = Missing::gap;
  EXPECT_THAT(expect_samples("nans.h5").notes, Contains(HasSubstr("rows 21 to 40 of wz, a, time")));
}

/// The command in the message must make a readable file.
TEST_F(H5pyFiles, OfAFilterThatIsAbsentAreCopiedByTheLineOfTheMessage) {
  options.inputs = "lzf.h5";
  const std::string message = error<DataError>();
  ASSERT_THAT(message, HasSubstr("filter 32000 (lzf) is not installed; copy the file without it: python3 -c"));
  const std::size_t begin = message.find("-c \"");
  ASSERT_EQ(python(message.substr(begin, message.rfind('"') + 1 - begin)), 0);
  EXPECT_EQ(expect_samples("lzf.plain.h5").recording.states.at(0).unit, "m");
}

}  // namespace
}  // namespace modebank
