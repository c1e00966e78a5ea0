// Groups of small arrays, read and written without HDF5: as HDF5 would, or not at all.
#include "io/hdf5/small_group.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "io/hdf5/array.hpp"
#include "io/hdf5/file_driver.hpp"
#include "io/hdf5/lookup3.hpp"
#include "io/hdf5/small_group_writer.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {
namespace {

using hdf5::Handle;
using hdf5::Place;

const double halves[] = {0.5, -1.5, 2.5, 1e300, 5e-324, -0.0};
const std::int32_t counts[] = {-1, 7, 1 << 30};

class SmallGroups : public testing::Test {
 protected:
  std::string path() const { return (folder_.path() / "file.h5").string(); }

  /// Writes group /runs/a and what `more` adds to it; returns the address of the group as HDF5 says it.
  template <class More>
  void write(More more) {
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "prepare"),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare");
    H5Pset_userblock(creation.id(), 512);
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18);
    const Handle file(H5Fcreate(path().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, "create");
    const Handle runs = group(file.id(), "runs"), a = group(runs.id(), "a");
    hdf5::write_array(a.id(), Place::dataset, "halves", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {3, 2}, halves);
    const Handle counted =
        hdf5::write_array(a.id(), Place::dataset, "counts", H5T_STD_I32LE, H5T_NATIVE_INT32, {3}, counts);
    hdf5::write_texts(counted.id(), Place::attribute, "units", {"1"}, {});
    hdf5::write_texts(a.id(), Place::attribute, "role", {"held out"}, {});
    hdf5::write_array(a.id(), Place::attribute, "lag_s", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {}, halves);
    more(a.id());
  }
  void write() {
    write([](hid_t) {});
  }
  static Handle group(hid_t parent, const char* name) {
    return {H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make a group"};
  }
  std::optional<hdf5::SmallGroup> read() const {
    const hdf5::Quiet quiet;
    const Handle file = hdf5::open_file(path()), root = hdf5::open_group(file.id(), "/"),
                 runs = hdf5::open_group(root.id(), "runs");
    hdf5::FileBytes bytes(root.id());
    return hdf5::read_small_group(bytes, hdf5::links_of(runs.id()).at(0).address);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(SmallGroups, HoldTheValuesThatWereWritten) {
  write();
  const auto group = read();
  ASSERT_TRUE(group);
  ASSERT_EQ(group->arrays.size(), 2u);
  const hdf5::SmallArray &real = group->arrays.at("halves"), &whole = group->arrays.at("counts"),
                         &role = group->attributes.at("role");
  EXPECT_EQ(real.shape, (hdf5::Shape{3, 2}));
  ASSERT_EQ(real.bytes.size(), sizeof halves);
  EXPECT_EQ(std::memcmp(real.bytes.data(), halves, sizeof halves), 0);
  std::int64_t wide[3];
  hdf5::StoredArray(whole, Place::dataset, "counts").read(H5T_NATIVE_INT64, wide);
  EXPECT_TRUE(std::equal(wide, wide + 3, counts));
  EXPECT_EQ(hdf5::StoredArray(role, Place::attribute, "role").texts(), std::vector<std::string>{"held out"});
  EXPECT_EQ(group->attributes.at("lag_s").shape, hdf5::Shape());
}

TEST_F(SmallGroups, AreLeftToHDF5WhereAnythingIsOfAnotherKind) {
  const float narrow = 1.0f;
  const std::vector<double> many(1000, 1.0);
  const std::function<void(hid_t)> others[] = {
      [&](hid_t a) { hdf5::write_array(a, Place::dataset, "narrow", H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {1}, &narrow); },
      [&](hid_t a) { hdf5::write_array(a, Place::dataset, "big", H5T_IEEE_F64BE, H5T_NATIVE_DOUBLE, {2}, halves); },
      [&](hid_t a) {
        hdf5::write_array(a, Place::dataset, "long", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {1000}, many.data());
      },
      [&](hid_t a) { hdf5::write_array(a, Place::dataset, "none", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {0}, halves); },
      [&](hid_t a) { group(a, "below"); },
      [&](hid_t a) { H5Lcreate_soft("/runs", a, "soft", H5P_DEFAULT, H5P_DEFAULT); },
      [&](hid_t a) { H5Lcreate_external("other.h5", "/", a, "external", H5P_DEFAULT, H5P_DEFAULT); },
      [&](hid_t a) { H5Lcreate_hard(a, "halves", a, "again", H5P_DEFAULT, H5P_DEFAULT); },
      [&](hid_t a) { H5Lcreate_hard(a, ".", a, "itself", H5P_DEFAULT, H5P_DEFAULT); },
      [&](hid_t a) {
        for (int i = 0; i < 20; ++i)
          hdf5::write_array(a, Place::dataset, "in a heap " + std::to_string(i), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {1},
                            halves);
      },
  };
  for (const auto& more : others) {
    write(more);
    EXPECT_FALSE(read()) << &more - others;
  }
}

TEST_F(SmallGroups, NoBitOfWhatIsReadCanChangeUnseen) {
  write();
  std::ifstream stream(path(), std::ios::binary);
  const std::string content(std::istreambuf_iterator<char>(stream), {});
  const auto first = content.find("OHDR"), last = content.size();
  for (std::size_t at = first; at < last; at += 13) {
    std::string changed = content;
    changed[at] = static_cast<char>(changed[at] ^ 16);
    std::ofstream(path(), std::ios::binary) << changed;
    try {
      const auto group = read();
      if (!group) continue;
      EXPECT_EQ(std::memcmp(group->arrays.at("halves").bytes.data(), halves, sizeof halves), 0) << at;
    } catch (const std::exception&) {  // HDF5's own refusal of the groups above
    }
  }
}

/// An array or attribute as HDF5 reads it: numbers as they lie in memory, texts one after another.
std::string bytes_of(const hdf5::StoredArray& array) {
  if (array.type_class() == H5T_STRING) {
    std::string all;
    for (const std::string& text : array.texts()) all += text + '\n';
    return all;
  }
  const bool real = array.type_class() == H5T_FLOAT;
  std::string bytes(array.elements() * 8, '\0');
  array.read(real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, bytes.data());
  return bytes;
}

/// What HDF5 says of a group: "path shape bytes" of everything in it.
std::vector<std::string> content_of(hid_t group) {
  std::vector<std::string> content;
  const auto add = [&](hid_t object, Place place, const std::string& name, const std::string& path) {
    const hdf5::StoredArray array(object, place, name);
    content.push_back(path + testing::PrintToString(array.shape()) + bytes_of(array));
  };
  for (const std::string& name : hdf5::attribute_names(group)) add(group, Place::attribute, name, "@" + name);
  for (const std::string& name : hdf5::member_names(group)) {
    add(group, Place::dataset, name, name);
    const hdf5::StoredArray array(group, Place::dataset, name);
    for (const std::string& attribute : hdf5::attribute_names(array.object()))
      add(array.object(), Place::attribute, attribute, name + "@" + attribute);
  }
  return content;
}

hdf5::NewSmallGroup some_group(std::size_t samples) {
  const std::int64_t origin = -(std::int64_t{1} << 60);
  const std::vector<double> values(samples, 0.1);
  hdf5::NewSmallGroup group;
  group.add_attribute("role", "held out, \u00e4");
  group.add_attribute("lag_s", H5T_IEEE_F64LE, halves);
  group.add_attribute("time_origin_ns", H5T_STD_I64LE, &origin);
  group.add_array("covariance", H5T_IEEE_F64LE, {1, 2, 3}, halves);
  group.add_unit({"(m/s)^2"}, {});
  group.add_array("mode", H5T_STD_I32LE, {3}, counts);
  group.add_array("state", H5T_IEEE_F64LE, {samples, 1}, values.data());
  group.add_unit({"m", "rad/s"}, {2});
  return group;
}

/// Writes so many groups to a file through a driver (none: HDF5's own), and what HDF5 then says of them.
std::vector<std::string> written(const std::filesystem::path& path, hid_t driver, std::size_t samples, int groups) {
  {
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "prepare"),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare");
    H5Pset_userblock(creation.id(), 512);
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18);
    if (driver >= 0) H5Pset_driver(access.id(), driver, nullptr);
    const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, "create");
    const Handle runs = hdf5::make_group(file.id(), "runs");
    for (int i = 0; i < groups; ++i) {
      some_group(samples).write(hdf5::appendable_file(runs.id()), runs.id(), "run " + std::to_string(i));
      hdf5::write_array(runs.id(), Place::dataset, "between " + std::to_string(i), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
                        {2, 3}, halves);  // HDF5 takes room of its own in between
    }
  }
  const hdf5::Quiet quiet;
  const Handle file = hdf5::open_file(path), runs = hdf5::open_group(file.id(), "runs");
  std::vector<std::string> all;
  for (int i = 0; i < groups; ++i)
    for (const std::string& line : content_of(hdf5::open_group(runs.id(), "run " + std::to_string(i)).id()))
      all.push_back(std::to_string(i) + line);
  return all;
}

TEST(NewSmallGroups, HoldWhatHDF5WouldHaveWritten) {
  const TemporaryFolder folder;
  for (const std::size_t samples : {1, 6, 512}) {  // of which the last has an array as long as a header takes
    const auto ours = written(folder.path() / "ours.h5", hdf5::file_driver(), samples, 40),
               theirs = written(folder.path() / "theirs.h5", H5I_INVALID_HID, samples, 40);
    EXPECT_EQ(ours, theirs);
    EXPECT_EQ(ours.size(), 40u * 8u);
  }
}

TEST(NewSmallGroups, AreHDF5sWhereTheyDoNotFit) {
  const TemporaryFolder folder;
  for (const std::size_t samples : {513, 20000})
    EXPECT_EQ(written(folder.path() / "ours.h5", hdf5::file_driver(), samples, 2),
              written(folder.path() / "theirs.h5", H5I_INVALID_HID, samples, 2));
}

TEST(Lookup3, IsTheOneOfItsAuthor) {
  const auto of = [](const std::string& text) {
    return hdf5::lookup3(reinterpret_cast<const unsigned char*>(text.data()), text.size());
  };
  EXPECT_EQ(of(""), 0xdeadbeefu);
  EXPECT_EQ(of("Four score and seven years ago"), 0x17770551u);  // driver5 of lookup3.c
}

}  // namespace
}  // namespace modebank::test
