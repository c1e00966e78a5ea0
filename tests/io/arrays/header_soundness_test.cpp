// Object headers that HDF5 1.10 would read beyond: refused before it sees them, in files and message by message.
#include <gmock/gmock.h>
#include <hdf5.h>

#include <filesystem>

#include "io/files/read_file.hpp"
#include "io/hdf5/handle.hpp"
#include "io/hdf5/message_soundness.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

using ::testing::HasSubstr;

/// How the file is written: by old rules or new ones, and what precedes it.
struct FileKind {
  bool is_new;
  hsize_t before;
};

class HeaderSoundness : public ::testing::TestWithParam<FileKind> {
 protected:
  HeaderSoundness() {
    write();
    content = read_file(path);
  }

  /// A group with so many attributes that its header is continued, and a table of one whole number.
  void write() const {
    const hdf5::Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "prepare"),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare");
    H5Pset_userblock(creation.id(), GetParam().before);
    if (GetParam().is_new) H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const hdf5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, "make"),
        group(H5Gcreate2(file.id(), "log", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make"),
        kind(H5Tcreate(H5T_COMPOUND, 4), H5Tclose, "make");
    const hsize_t three = 3;
    const hdf5::Handle space(H5Screate_simple(1, &three, nullptr), H5Sclose, "make");
    for (const char* name : {"a", "b", "c", "d", "e", "f", "gain"})
      hdf5::Handle(H5Acreate2(group.id(), name, H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                   "make");
    H5Tinsert(kind.id(), "count", 0, H5T_STD_I32LE);
    hdf5::Handle(H5Dcreate2(file.id(), "table", kind.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
                 "make");
  }

  /// Why the file is not read; empty where it is.
  std::string refusal(std::string_view bytes) const {
    test::write_file(path, std::string(bytes));
    const hdf5::Quiet quiet;
    try {
      const hdf5::Handle file = hdf5::open_file(path.string()), group = hdf5::open_group(file.id(), "log");
      EXPECT_EQ(hdf5::attribute_names(group.id()).size(), 7U);
      const hdf5::Handle data(H5Dopen2(file.id(), "table", H5P_DEFAULT), H5Dclose, "open the table");
    } catch (const DataError& error) {
      return error.what();
    }
    return {};
  }

  /// With these bytes changed, `at` from the name of the attribute on.
  std::string changed(std::ptrdiff_t at, std::string_view bytes) const {
    std::string copy = content;
    const auto name = static_cast<std::ptrdiff_t>(copy.find(std::string_view("gain\0", 5)));
    return copy.replace(static_cast<std::size_t>(name + at), bytes.size(), bytes);
  }

  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "log.h5";
  std::string content;
};

TEST_P(HeaderSoundness, WholeFilesAreRead) { EXPECT_EQ(refusal(content), ""); }

TEST_P(HeaderSoundness, AttributesThatAreLongerThanTheirMessageAreRefused) {
  const bool is_new = GetParam().is_new;
  const std::ptrdiff_t sizes = is_new ? -7 : -6, type = is_new ? 5 : 8, extent = is_new ? type + 24 : type + 32;
  const std::string large("\xff\x7f", 2);
  EXPECT_THAT(refusal(changed(sizes, large)), HasSubstr("an attribute in an object header is larger than its message"));
  EXPECT_THAT(refusal(changed(sizes, {"\x03\0", 2})), HasSubstr("an attribute's name does not end where it says"));
  for (const std::ptrdiff_t at : {sizes + 2, sizes + 4, extent + 1})
    EXPECT_THAT(refusal(changed(at, large)),
                HasSubstr("the attribute 'gain' in an object header is larger than its message"));
  EXPECT_THAT(refusal(changed(type, "\x16")), HasSubstr("larger than its message"));  // a compound
  EXPECT_THAT(refusal(changed(type, "\x1b")), HasSubstr("a datatype is of an unknown class"));
  EXPECT_THAT(refusal(changed(type + 13, "\xc8")), HasSubstr("a number's bits lie outside of it"));
}

TEST_P(HeaderSoundness, BitsOutsideOfAMemberAreRefused) {
  const std::string_view four_bytes("\x08\0\0\4\0\0\0\0\0\x20\0", 11);
  const std::size_t at = content.find(four_bytes) + 9;
  ASSERT_LT(at, content.size());
  for (const char bits : {'\x21', '\0'}) {
    std::string copy = content;
    copy[at] = bits;
    EXPECT_THAT(refusal(copy), HasSubstr("a number's bits lie outside of it"));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, HeaderSoundness,
                         ::testing::Values(FileKind{false, 0}, FileKind{false, 512}, FileKind{true, 0},
                                           FileKind{true, 512}));

/// Numbers of these widths one after another.
std::string numbers(std::initializer_list<std::pair<std::uint64_t, int>> all) {
  std::string bytes;
  for (const auto& [value, width] : all)
    for (int i = 0; i < width; ++i) bytes += static_cast<char>(value >> 8 * i);
  return bytes;
}

std::string reason(std::uint64_t kind, const std::string& content, bool shared = false) {
  const auto type_at = [](haddr_t at) -> std::uint64_t {
    if (at != 96) throw hdf5::Unsound{"no datatype"};
    return 8;
  };
  try {
    hdf5::require_sound_message({kind, shared, content}, {}, type_at);
  } catch (const hdf5::Unsound& unsound) {
    return unsound.reason;
  }
  return "sound";
}

const std::string byte_type = numbers({{0x10, 1}, {0, 3}, {1, 4}, {0, 2}, {8, 2}});

TEST(MessageSoundness, TypesMustFitEachOther) {
  constexpr std::uint64_t datatype = 3;
  const auto type = [](std::uint64_t first, std::uint64_t flags, std::uint64_t bytes) {
    return numbers({{first, 1}, {flags, 3}, {bytes, 4}});
  };
  EXPECT_EQ(reason(datatype, byte_type), "sound");
  EXPECT_EQ(reason(datatype, byte_type.substr(0, 11)), "a message in an object header is longer than it is");
  EXPECT_EQ(reason(datatype, type(0x19, 0, 16) + byte_type), "sound");
  EXPECT_THAT(reason(datatype, type(0x19, 0, 4) + byte_type), HasSubstr("variable length"));
  const std::string three = numbers({{1, 1}, {3, 4}});
  EXPECT_EQ(reason(datatype, type(0x3a, 0, 3) + three + byte_type), "sound");
  EXPECT_THAT(reason(datatype, type(0x3a, 0, 4) + three + byte_type), HasSubstr("an array"));
  const std::string member = std::string("x\0", 2) + '\1' + byte_type;
  EXPECT_EQ(reason(datatype, type(0x36, 1, 2) + member), "sound");
  EXPECT_THAT(reason(datatype, type(0x36, 1, 1) + member), HasSubstr("member lies outside"));
  EXPECT_THAT(reason(datatype, type(0x36, 2, 2) + member), HasSubstr("longer than it is"));
  EXPECT_EQ(reason(datatype, type(0x38, 1, 1) + byte_type + std::string("x\0\1", 3)), "sound");
  EXPECT_THAT(reason(datatype, type(0x38, 1, 1) + byte_type + "no_end"), HasSubstr("longer than it is"));
  EXPECT_THAT(reason(datatype, type(0x15, 8, 1) + "tag"), HasSubstr("longer than it is"));
  EXPECT_THAT(reason(datatype, type(0x17, 0, 12)), HasSubstr("a reference"));
  EXPECT_THAT(reason(datatype, type(0x10, 0, 0)), HasSubstr("no size"));
  std::string nested;
  for (int i = 0; i < 40; ++i) nested += type(0x19, 0, 16);
  EXPECT_THAT(reason(datatype, nested), HasSubstr("nested too deeply"));
}

TEST(MessageSoundness, CommittedTypesAreLookedAt) {
  constexpr std::uint64_t datatype = 3, attribute = 12;
  const auto pointer = [](std::uint64_t at) { return numbers({{3, 1}, {2, 1}, {at, 8}}); };
  EXPECT_EQ(reason(datatype, pointer(96), true), "sound");
  EXPECT_EQ(reason(datatype, pointer(97), true), "no datatype");
  EXPECT_EQ(reason(datatype, pointer(96).substr(0, 9), true), "a message in an object header is longer than it is");
  const auto with = [&](std::uint64_t at, std::uint64_t bytes) {
    return numbers({{3, 1}, {1, 1}, {2, 2}, {10, 2}, {4, 2}, {0, 1}}) + std::string("k\0", 2) + pointer(at) +
           numbers({{2, 1}, {0, 3}}) + std::string(bytes, 'v');
  };
  EXPECT_EQ(reason(attribute, with(96, 8)), "sound");
  EXPECT_EQ(reason(attribute, with(96, 7)), "the attribute 'k' in an object header is larger than its message");
  EXPECT_EQ(reason(attribute, with(0, 8)), "no datatype");
  EXPECT_THAT(reason(attribute, with(96, 8), true), HasSubstr("a table of shared messages"));
}

TEST(MessageSoundness, ValuesAndNamesInOtherMessagesEnd) {
  constexpr std::uint64_t dataspace = 1, old_fill = 4, fill = 5, layout = 8, filters = 11, comment = 13, symbols = 17,
                          attribute_info = 21, cache_image = 24;
  const std::string longer = "a message in an object header is longer than it is";
  EXPECT_EQ(reason(dataspace, numbers({{2, 1}, {1, 1}, {0, 1}, {1, 1}, {7, 8}})), "sound");
  EXPECT_EQ(reason(dataspace, numbers({{2, 1}, {1, 1}, {1, 1}, {1, 1}, {7, 8}})), longer);
  EXPECT_EQ(reason(old_fill, numbers({{2, 4}, {7, 2}})), "sound");
  EXPECT_EQ(reason(old_fill, numbers({{3, 4}, {7, 2}})), longer);
  EXPECT_EQ(reason(fill, numbers({{3, 1}, {0x2a, 1}, {2, 4}, {7, 2}})), "sound");
  EXPECT_EQ(reason(fill, numbers({{3, 1}, {0x2a, 1}, {3, 4}, {7, 2}})), longer);
  EXPECT_EQ(reason(fill, numbers({{2, 1}, {2, 1}, {0, 1}, {1, 1}, {0xffffffff, 4}})), "sound");
  EXPECT_EQ(reason(layout, numbers({{3, 1}, {0, 1}, {2, 2}, {7, 2}})), "sound");
  EXPECT_EQ(reason(layout, numbers({{3, 1}, {0, 1}, {3, 2}, {7, 2}})), longer);
  EXPECT_EQ(reason(filters, numbers({{2, 1}, {1, 1}, {1, 2}, {0, 2}, {1, 2}, {6, 4}})), "sound");
  EXPECT_EQ(reason(filters, numbers({{2, 1}, {1, 1}, {1, 2}, {0, 2}, {9, 2}, {6, 4}})), longer);
  EXPECT_EQ(reason(comment, "no end"), longer);
  EXPECT_EQ(reason(symbols, std::string(16, 'x')), "sound");
  EXPECT_EQ(reason(symbols, std::string(15, 'x')), longer);
  EXPECT_EQ(reason(attribute_info, numbers({{0, 1}, {3, 1}, {0, 2}, {0, 8}, {0, 8}, {0, 8}})), "sound");
  EXPECT_EQ(reason(attribute_info, numbers({{0, 1}, {3, 1}, {0, 2}, {0, 8}, {0, 8}, {0, 7}})), longer);
  EXPECT_EQ(reason(99, "anything"), "sound");
  EXPECT_EQ(reason(cache_image, "anything"), "the file holds an image of HDF5's memory, which is not read");
}

}  // namespace
}  // namespace modebank
