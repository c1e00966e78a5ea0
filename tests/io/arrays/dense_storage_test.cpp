// Heaps of many links and attributes, and the trees that lead there: judged before HDF5 decodes what lies in them.
#include <gmock/gmock.h>
#include <hdf5.h>

#include <filesystem>

#include "io/files/read_file.hpp"
#include "io/hdf5/handle.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using ::testing::HasSubstr;

/// A group with more links than its header holds and an object with more attributes, one of them too large for a block
/// of the heap: HDF5 keeps them in heaps of their own, which trees lead to.
class DenseStorage : public ::testing::Test {
 protected:
  static constexpr int many = 80;

  DenseStorage() {
    const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare"),
        creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "prepare");
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_attr_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    const hdf5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, "make"),
        group(H5Gcreate2(file.id(), "log", H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose, "make");
    for (int i = 0; i < many; ++i) {
      const std::string name = "gain_" + std::to_string(100 + i);
      add_attribute(group.id(), name, 3);
      hdf5::Handle(H5Gcreate2(group.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make");
    }
    add_attribute(group.id(), "wide", 700);
  }

  static void add_attribute(hid_t object, const std::string& name, hsize_t values) {
    const hdf5::Handle space(H5Screate_simple(1, &values, nullptr), H5Sclose, "make"),
        attribute(H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                  "make");
    const std::vector<double> zeros(static_cast<std::size_t>(values));
    H5Awrite(attribute.id(), H5T_NATIVE_DOUBLE, zeros.data());
  }

  std::string refusal() const {
    const hdf5::Quiet quiet;
    try {
      const hdf5::Handle file = hdf5::open_file(path.string()), group = hdf5::open_group(file.id(), "log");
      EXPECT_EQ(hdf5::attribute_names(group.id()).size(), many + 1U);
      EXPECT_EQ(hdf5::member_names(group.id()).size(), static_cast<std::size_t>(many));
    } catch (const DataError& error) {
      return error.what();
    }
    return {};
  }

  /// With bytes changed so far behind these letters. Headers are judged before HDF5 looks at checksums.
  std::string changed(const std::string& letters, std::size_t at, std::string_view bytes) const {
    std::string copy = read_file(path);
    const std::size_t begin = copy.find(letters);
    EXPECT_NE(begin, std::string::npos);
    test::write_file(path, copy.replace(begin + at, bytes.size(), bytes));
    return refusal();
  }

  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "log.h5";
};

TEST_F(DenseStorage, IsReadWhereItIsSound) { EXPECT_EQ(refusal(), ""); }

/// HDF5 decodes what lies in a heap without knowing where it ends, too.
TEST_F(DenseStorage, AttributesThatAreLongerThanTheirMessageAreRefused) {
  const std::string message("gain_142\0", 9);
  std::string content = read_file(path);
  const std::size_t type_bytes_at = content.find(message + '\x11') - 5;  // behind the name: a number's type
  content[type_bytes_at + 3] = '\x7f';                                   // the extents' bytes, as the message says
  test::write_file(path, content);
  EXPECT_THAT(refusal(), HasSubstr("the attribute 'gain_142' in an object header is larger than its message"));
}

TEST_F(DenseStorage, LargeAttributesAreJudgedToo) {
  std::string content = read_file(path);
  const std::size_t type_bytes_at = content.find(std::string("wide\0\x11", 6)) - 5;
  content[type_bytes_at + 3] = '\x7f';
  test::write_file(path, content);
  EXPECT_THAT(refusal(), HasSubstr("the attribute 'wide' in an object header is larger than its message"));
}

/// HDF5 gives a node as much memory as the header's sizes ask for, and fills it with as many records as is said.
TEST_F(DenseStorage, TreesThatAreNotAsHdf5MakesThemAreRefused) {
  const std::string whole = read_file(path), damaged = "an index of links or attributes is damaged";
  const auto refuses = [&](const std::string& letters, std::size_t at, std::string_view bytes) {
    EXPECT_THAT(changed(letters, at, bytes), HasSubstr(damaged)) << letters << " " << at;
    test::write_file(path, whole);
  };
  refuses("BTHD", 6, std::string_view("\x00\x10", 2));  // bytes of a node
  refuses("BTHD", 10, std::string_view("\0\0", 2));     // of a record
  refuses("BTHD", 12, "\x60");                          // levels
  refuses("BTHD", 24, "\xff\xff");                      // records of the root
  EXPECT_THAT(changed("BTHD", 16, std::string_view("\xff\xff\xff\xff\xff\xff\xff\x7f", 8)), HasSubstr("is damaged"));
  test::write_file(path, whole);  // where it lies
  refuses("BTIN", 0, "BTLF");
  refuses("BTLF", 5, "\x0b");
}

TEST_F(DenseStorage, HeapsThatAreNotAsHdf5MakesThemAreRefused) {
  const std::string whole = read_file(path);
  const auto refuses = [&](const std::string& letters, std::size_t at, std::string_view bytes) {
    EXPECT_THAT(changed(letters, at, bytes), HasSubstr("a heap of links or attributes is")) << letters << " " << at;
    test::write_file(path, whole);
  };
  refuses("FRHP", 5, "\x09");    // bytes of an identifier
  refuses("FRHP", 7, "\x01");    // filters
  refuses("FRHP", 110, "\x03");  // blocks in a row
  refuses("FRHP", 140, "\xff");  // rows
  refuses("FHIB", 13, "\x01");   // where in the heap it begins
  refuses("FHDB", 5, "\x01");    // whose it is
}

}  // namespace
}  // namespace modebank
