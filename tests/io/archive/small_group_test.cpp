// Groups of small arrays, read without HDF5: with HDF5's own values, or not at all.
#include "io/hdf5/small_group.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "io/hdf5/array.hpp"
#include "io/hdf5/lookup3.hpp"
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
  for (std::size_t at = first; at < last; at += 3) {
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

TEST(Lookup3, IsTheOneOfItsAuthor) {
  const auto of = [](const std::string& text) {
    return hdf5::lookup3(reinterpret_cast<const unsigned char*>(text.data()), text.size());
  };
  EXPECT_EQ(of(""), 0xdeadbeefu);
  EXPECT_EQ(of("Four score and seven years ago"), 0x17770551u);  // driver5 of lookup3.c
}

}  // namespace
}  // namespace modebank::test
