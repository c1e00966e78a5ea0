#include "io/arrays/stored_columns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "io/arrays/array_reader.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/arrays/mat_writer.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using test::MatWriter;
using test::message_of;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::vector<std::string> paths(const ColumnStore& store) {
  std::vector<std::string> names;
  for (const StoredColumn& column : store.columns()) names.push_back(column.path());
  return names;
}

std::size_t position(const ColumnStore& store, const std::string& path) {
  const std::vector<std::string> names = paths(store);
  const auto found = std::find(names.begin(), names.end(), path);
  if (found == names.end()) ADD_FAILURE() << "no column " << path;
  return static_cast<std::size_t>(found - names.begin()) % names.size();
}

std::vector<double> numbers(const ColumnStore& store, const std::string& path) {
  return store.numbers(position(store, path));
}

/// The version of the file, and whether it is compressed.
class MatFiles : public ::testing::TestWithParam<std::pair<mat_ft, matio_compression>> {
 protected:
  MatWriter writer() const { return {file, GetParam().first, GetParam().second}; }
  std::unique_ptr<ColumnStore> open() const {
    return GetParam().first == MAT_FT_MAT73 ? open_hdf5_columns(file) : open_mat_columns(file);
  }

  TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "log.mat";
};

INSTANTIATE_TEST_SUITE_P(Versions, MatFiles,
                         ::testing::Values(std::pair(MAT_FT_MAT5, MAT_COMPRESSION_NONE),
                                           std::pair(MAT_FT_MAT5, MAT_COMPRESSION_ZLIB),
                                           std::pair(MAT_FT_MAT73, MAT_COMPRESSION_NONE),
                                           std::pair(MAT_FT_MAT73, MAT_COMPRESSION_ZLIB)));

TEST_P(MatFiles, GiveVectorsMatricesAndNestedStructs) {
  writer().write(MatWriter::matrix("t", {0.0, 0.5, 1.0}, 1));  // the file must be closed before the next one opens
  {
    MatWriter all = writer();
    all.write(MatWriter::matrix("t", {0.0, 0.5, 1.0}, 1));
    all.write(MatWriter::matrix("pose", {1, 2, 3, 4, 5, 6}, 3));
    all.write(MatWriter::matrix("mass", {7.0}, 1));
    all.write(MatWriter::whole("stamp", {1'700'000'000'000'000'001, 1'700'000'000'000'000'002}));
    matvar_t* imu = MatWriter::structure("imu", {"wz"}, {{MatWriter::matrix("wz", {0.1, 0.2, 0.3}, 3)}});
    all.write(MatWriter::structure("log", {"imu", "v"}, {{imu, MatWriter::matrix("v", {4, 5, 6}, 3)}}));
  }
  const auto store = open();
  EXPECT_THAT(paths(*store), UnorderedElementsAre("t", "pose[0]", "pose[1]", "stamp", "log.imu.wz", "log.v"));
  EXPECT_THAT(numbers(*store, "t"), ElementsAre(0.0, 0.5, 1.0));
  EXPECT_THAT(numbers(*store, "pose[1]"), ElementsAre(4, 5, 6));
  EXPECT_THAT(numbers(*store, "log.imu.wz"), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(store->whole_numbers(position(*store, "stamp")),
              ElementsAre(1'700'000'000'000'000'001, 1'700'000'000'000'000'002));
  EXPECT_EQ(store->columns()[position(*store, "log.imu.wz")].group, "log.imu");
}

/// tests/golden/generate/mat_objects.py made these files. scipy wrote them; one has the form of MATLAB's own class
/// system.
TEST(MatObjects, AreNamedAsFarAsMatioDoes) {
  const auto message = [](const char* name) {
    return message_of<ConfigurationError>([&] { open_mat_columns(test::golden_dir() / name); });
  };
  EXPECT_THAT(message("mat_iddata.mat"),
              AllOf(HasSubstr("z is a MATLAB object (class(z) names its kind): convert an iddata in MATLAB with s = "),
                    HasSubstr("save z_plain s -v7"), HasSubstr("modebank.read_iddata(")));
  EXPECT_THAT(message("mat_table.mat"), HasSubstr("a table T with s = table2struct(T, 'ToScalar', true)"));
  const auto beside = open_mat_columns(test::golden_dir() / "mat_iddata_and_t.mat");
  EXPECT_THAT(paths(*beside), ElementsAre("t"));
  EXPECT_THAT(beside->left_out(), ElementsAre(HasSubstr("z is a MATLAB object")));
}

TEST(OtherFormats, AreRefusedInMatiosWords) {
  const TemporaryFolder folder;
  test::write_file(folder.path() / "log.mat", "MATLAB 5.0 MAT-file");
  EXPECT_THAT(message_of<DataError>([&] { open_mat_columns(folder.path() / "log.mat"); }),
              AllOf(HasSubstr("log.mat: matio cannot read this MATLAB file"), HasSubstr("save plain -struct s -v7")));
}

class Hdf5Files : public ::testing::Test {
 protected:
  hid_t create() { return H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT); }

  static void dataset(hid_t parent, const char* name, std::vector<hsize_t> shape, const std::vector<double>& values) {
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t data = H5Dcreate2(parent, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(data);
    H5Sclose(space);
  }
  static void text_attribute(hid_t object, const char* name, const std::string& value) {
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, value.size());
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, value.data());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
  }

  TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "log.h5";
};

TEST_F(Hdf5Files, GiveGroupsOfDatasets) {
  const hid_t id = create(), group = H5Gcreate2(id, "imu", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  dataset(group, "t", {3}, {0, 1, 2});
  dataset(group, "gyro", {3, 2}, {1, 2, 3, 4, 5, 6});
  dataset(group, "across", {2, 3}, {1, 2, 3, 4, 5, 6});
  dataset(group, "gain", {1}, {2.0});
  H5Lcreate_hard(id, "/", group, "round", H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(group);
  H5Fclose(id);
  const auto store = open_hdf5_columns(file);
  EXPECT_THAT(paths(*store),
              UnorderedElementsAre("imu.t", "imu.gyro[0]", "imu.gyro[1]", "imu.across[0]", "imu.across[1]"));
  EXPECT_THAT(numbers(*store, "imu.gyro[1]"), ElementsAre(2, 4, 6));
  EXPECT_THAT(numbers(*store, "imu.across[1]"), ElementsAre(4, 5, 6)) << "rows are as many as t has";
}

TEST_F(Hdf5Files, GiveUnits) {
  const hid_t id = create();
  dataset(id, "v", {2}, {0, 1});
  const hid_t v = H5Dopen2(id, "v", H5P_DEFAULT);
  text_attribute(v, "units", "m/s");
  H5Dclose(v);
  H5Fclose(id);
  EXPECT_EQ(open_hdf5_columns(file)->columns()[0].unit, "m/s");
}

TEST_F(Hdf5Files, FollowNothingOutside) {
  const hid_t other = H5Fcreate((folder.path() / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  dataset(other, "secret", {2}, {1, 2});
  H5Fclose(other);
  const hid_t id = create();
  H5Lcreate_external("other.h5", "/secret", id, "x", H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t shape = 2;
  const hid_t space = H5Screate_simple(1, &shape, nullptr), made = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(made, "/etc/hostname", 0, H5F_UNLIMITED);
  H5Dclose(H5Dcreate2(id, "y", H5T_NATIVE_INT8, space, H5P_DEFAULT, made, H5P_DEFAULT));
  H5Pclose(made);
  H5Sclose(space);
  H5Fclose(id);
  EXPECT_THAT(message_of<ConfigurationError>([&] { open_hdf5_columns(file); }),
              AllOf(HasSubstr("/x lies in another file, which is not followed"),
                    HasSubstr("/y lies in another file, which is not followed")));
}

TEST_F(Hdf5Files, OfOursAreRefused) {
  const hid_t id = create();
  text_attribute(id, "format", "modebank archive");
  H5Fclose(id);
  EXPECT_THAT(message_of<ConfigurationError>([&] { open_hdf5_columns(file); }), HasSubstr("modebank show"));
}

TEST_F(Hdf5Files, NameMatlabsObjects) {
  const hid_t id = create();
  dataset(id, "speed", {6}, {0, 1, 2, 3, 4, 5});
  const hid_t speed = H5Dopen2(id, "speed", H5P_DEFAULT);
  text_attribute(speed, "MATLAB_class", "timeseries");
  H5Dclose(speed);
  H5Fclose(id);
  EXPECT_THAT(message_of<ConfigurationError>([&] { open_hdf5_columns(file); }),
              HasSubstr("speed is a MATLAB timeseries: convert it in MATLAB with s = struct('t', speed.Time"));
}

TEST_F(Hdf5Files, GiveBitsOfAnyLengthAsNumbers) {
  const hid_t id = create();
  const hsize_t shape = 3;
  const std::uint16_t flags[]{0, 256, 65535};
  const hid_t space = H5Screate_simple(1, &shape, nullptr),
              data = H5Dcreate2(id, "flags", H5T_STD_B16BE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(data, H5T_NATIVE_B16, H5S_ALL, H5S_ALL, H5P_DEFAULT, flags);
  H5Dclose(data);
  H5Sclose(space);
  H5Fclose(id);
  EXPECT_THAT(numbers(*open_hdf5_columns(file), "flags"), ElementsAre(0.0, 256.0, 65535.0));
}

TEST_F(Hdf5Files, OfAForeignFilterSayHowToWriteThem) {
  const hid_t id = create();
  const hsize_t shape = 2;
  const double values[]{1.0, 2.0};
  const hid_t space = H5Screate_simple(1, &shape, nullptr), made = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(made, 1, &shape);
  H5Pset_filter(made, 32001, H5Z_FLAG_OPTIONAL, 0, nullptr);
  const hid_t data = H5Dcreate2(id, "v", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, made, H5P_DEFAULT);
  const hsize_t first = 0;
  H5Dwrite_chunk(data, H5P_DEFAULT, 0, &first, sizeof(values), values);
  H5Dclose(data);
  H5Pclose(made);
  H5Sclose(space);
  H5Fclose(id);
  const auto store = open_hdf5_columns(file);
  EXPECT_THAT(message_of<DataError>([&] { numbers(*store, "v"); }), HasSubstr("filter 32001"));
}

/// A frame of pandas and a variable of Octave's -hdf5 are refused with the line that converts them.
TEST_F(Hdf5Files, NameFramesOfPandasAndVariablesOfOctave) {
  const hid_t id = create();
  const hid_t frame = H5Gcreate2(id, "drive", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  text_attribute(frame, "pandas_type", "frame");
  dataset(frame, "block0_values", {3, 2}, {1, 2, 3, 4, 5, 6});
  const hid_t variable = H5Gcreate2(id, "x", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  text_attribute(variable, "OCTAVE_NEW_FORMAT", "1");
  dataset(variable, "value", {3}, {1, 2, 3});
  for (const hid_t group : {frame, variable}) H5Gclose(group);
  H5Fclose(id);
  EXPECT_THAT(message_of<ConfigurationError>([&] { open_hdf5_columns(file); }),
              AllOf(HasSubstr("pandas.read_hdf('" + file.string() + "', '/drive')"), HasSubstr("save('-v7'")));
}

}  // namespace
}  // namespace modebank
