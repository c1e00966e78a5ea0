#include <boost/random/uniform_int_distribution.hpp>
#include <cmath>
#include <cstdlib>

#include "ident/base/seed.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/bank/stored_bank.hpp"
#include "io/archive/inspect.hpp"
#include "io/archive/study_file.hpp"
#include "tests/io/archive/archive_file_fixture.hpp"
#include "tests/io/archive/archive_patch.hpp"
#include "tests/support/effort.hpp"

// HDF5 1.10 leaks memory at a wrong metadata checksum. The sanitizer build must still report leaks in modebank.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }     // NOLINT
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }  // NOLINT

namespace modebank {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ArchiveDamage : public test::ArchiveFile {};

TEST_F(ArchiveDamage, EveryFlippedByteIsFound) {
  const std::string bytes = read_file(path);
  std::mt19937_64 generator = make_generator(7, "flips");
  boost::random::uniform_int_distribution<std::size_t> anywhere(0, bytes.size() - 1), in_block(0, 511);
  boost::random::uniform_int_distribution<int> change(1, 255);
  for (int trial = 0; trial < test::in_release(200, 40); ++trial) {
    std::string damaged = bytes;
    char& byte = damaged[trial % 4 == 0 ? in_block(generator) : anywhere(generator)];
    byte = static_cast<char>(byte ^ change(generator));
    test::write_file(path, damaged);
    ASSERT_FALSE(verify_archive(path).ok()) << "trial " << trial;
    ASSERT_THROW(read_archive(path), DataError) << "trial " << trial;
  }
}

TEST_F(ArchiveDamage, TruncatedFilesAreErrorsAtEveryLength) {
  constexpr std::size_t pieces = test::in_release(97, 31);
  const std::string bytes = read_file(path);
  for (std::size_t length = 1; length < bytes.size(); length += 1 + bytes.size() / pieces) {
    test::write_file(path, bytes.substr(0, length));
    EXPECT_THROW(read_archive(path), DataError) << length;
    EXPECT_FALSE(verify_archive(path).ok()) << length;
  }
  test::write_file(path, bytes.substr(0, bytes.size() - 1));
  expect_unreadable("truncated file");
}

TEST_F(ArchiveDamage, AFileThatHdf5CannotOpenIsCalledDamaged) {
  std::string bytes = read_file(path);
  bytes[bytes.find("OHDR") + 5] ^= 1;  // the object header of the root group
  test::write_file(path, bytes);
  const auto says = ThrowsMessage<DataError>(AllOf(HasSubstr(path.string()), HasSubstr("damaged")));
  EXPECT_THAT([&] { read_archive(path); }, says);
  EXPECT_THAT([&] { load_bank(path); }, says);
}

TEST_F(ArchiveDamage, ATrialsScoresAreReadOrAnError) {
  EXPECT_EQ(read_trial_scores(path).config_hash, read_archive(path).provenance.config_hash);
  test::empty_text_attribute(path, "/", "config_hash");
  EXPECT_THAT([&] { read_trial_scores(path); }, ThrowsMessage<DataError>(HasSubstr("config_hash")));
  const std::vector<SummaryRow> summary = test::full_archive(2, 1).summary;
  EXPECT_NO_THROW(pooled_scores(summary, {"wz", "vx"}));
  EXPECT_THROW(pooled_scores(summary, {"wz"}), DataError);
}

TEST_F(ArchiveDamage, WhatIsNotAnArchiveIsNamed) {
  test::write_file(path, "");
  expect_unreadable("the file is empty");
  test::write_file(path, std::string(4096, 'x'));
  expect_unreadable("not a modebank archive");
  EXPECT_THAT([&] { read_archive(folder.path()); }, ThrowsMessage<DataError>(HasSubstr("is a folder")));
  EXPECT_THAT(verify_archive(folder.path()).problems, Contains(HasSubstr("is a folder")));
  EXPECT_THAT([&] { read_archive("/dev/null"); }, ThrowsMessage<DataError>(HasSubstr("not a regular file")));
  EXPECT_THROW(read_archive(folder.path() / "none.h5"), ConfigurationError);
  EXPECT_THROW(verify_archive(folder.path() / "none.h5"), ConfigurationError);
}

TEST_F(ArchiveDamage, ForeignHdf5AndOtherSchemasAreNamed) {
  test::write_foreign_hdf5(path, 0);
  expect_unreadable("HDF5 file of another program");
  test::write_foreign_hdf5(path, 512);
  expect_unreadable("not a modebank archive");
  write_archive(path, test::full_archive(2, 1));
  test::patch_text_attribute(path, "/", "schema_version", "4.7");
  EXPECT_NO_THROW(read_archive(path));
  test::patch_text_attribute(path, "/", "schema_version", "5.0");
  expect_unreadable("schema 5.0 is newer than 4.0");
  test::patch_text_attribute(path, "/", "schema_version", "3.0");
  expect_unreadable("made by an older modebank; run again");
  test::patch_text_attribute(path, "/", "schema_version", "two");
  expect_unreadable("is not a version");
  test::patch_text_attribute(path, "/", "schema_version", "4.0");
  test::patch_text_attribute(path, "/", "format", "othertool");
  expect_unreadable("not a modebank archive");
}

// An archive of the first release. Later releases have more columns at the end of the table of candidates.
TEST_F(ArchiveDamage, MissingColumnsAreNamed) {
  test::keep_columns(path, "/mixture/candidates", 10);
  expect_unreadable("column 'selected' is missing");
}

TEST_F(ArchiveDamage, MissingMembersAreAllListed) {
  test::remove_member(path, "/windows/parameters");
  test::remove_member(path, "/bank/transition");
  test::remove_member(path, "/evaluation/baseline/pit");
  EXPECT_THAT(
      verify_archive(path).problems,
      AllOf(Contains(HasSubstr("/windows/parameters: is missing")), Contains(HasSubstr("/bank/transition: is missing")),
            Contains(HasSubstr("/evaluation/baseline/pit: is missing")), ::testing::SizeIs(3)));
  expect_unreadable("/windows/parameters: is missing");
}

TEST_F(ArchiveDamage, ShapesThatDisagreeAreErrors) {
  test::replace_by_zeros(path, "/mixture/labels", {8}, test::Kind::integer);
  expect_unreadable("/mixture/labels: has shape (8), but M is 9");
}

TEST_F(ArchiveDamage, HostileContentIsAnErrorAndNeverMore) {
  const auto refuses = [&](const std::string& member, const std::vector<unsigned long long>& shape, test::Kind kind,
                           const std::string& reason) {
    write_archive(path, test::full_archive(2, 1));
    test::replace_by_zeros(path, member, shape, kind);
    expect_unreadable(reason);
  };
  const unsigned long long huge = 1ull << 40;
  refuses("/windows/parameters", {huge, 8}, test::Kind::real, "declares more content than the file has");
  refuses("/windows/parameters", {0, huge}, test::Kind::real, "declares more content than the file has");
  refuses("/windows/parameters", {9}, test::Kind::real, "must have the dimensions");
  refuses("/windows/parameters", {9, 8}, test::Kind::integer, "another type");
  refuses("/windows/run", {9}, test::Kind::real, "fixed-length strings");
  refuses("/bank/B", {3, 2, 2}, test::Kind::real, "inputs");
  refuses("/baseline/parameters", {1, 7}, test::Kind::real, "do not fit");
  refuses("/mixture/candidates", {2}, test::Kind::real, "not a table");
  refuses("/bank/weight", {3}, test::Kind::text, "another type");
}

/// Archives with invalid weights of transitions must never give a bank.
TEST(StoredSwitches, OfOtherSizesOrNoNumbersAreRefused) {
  const Bank bank = *test::full_archive(2, 1).bank;
  const auto refuses = [&](void (*change)(StoredBank&), const std::string& reason) {
    StoredBank stored = store_bank(bank);
    change(stored);
    EXPECT_THAT([&] { restore_bank(stored, Bank()); }, ThrowsMessage<std::exception>(HasSubstr(reason)));
  };
  refuses([](StoredBank& s) { s.transition_weights(0, 0) = std::nan(""); }, "depend on the previous mode");
  refuses([](StoredBank& s) { s.transition_weights.row(0).setConstant(HUGE_VAL); }, "not finite");
  refuses([](StoredBank& s) { s.transition_reference(1) = std::nan(""); }, "not finite");
  refuses([](StoredBank& s) { s.transition_reference.conservativeResize(1); }, "number of features");
  refuses([](StoredBank& s) { s.transition_weights.conservativeResize(3, Eigen::NoChange); }, "number of features");
  refuses(
      [](StoredBank& s) {
        const Index more = s.transition_reference.size() + 1;
        s.transition_weights.setZero(s.weight.size() * more, s.weight.size());
        s.transition_reference.setZero(more);
      },
      "weights of the transition");
  refuses([](StoredBank& s) { s.transition_weights(0, 1) += 1.0; }, "depend on the previous mode");
  refuses([](StoredBank& s) { s.transition_weights.resize(0, 0); }, "no transition weights");
  StoredBank huge = store_bank(bank);  // any finite value is accepted, because other code bounds the log odds
  huge.transition_weights.setConstant(1e300);
  EXPECT_NO_THROW(restore_bank(huge, Bank()));
}

TEST_F(ArchiveDamage, ContentElsewhereIsRefused) {
  test::replace_by_external(path, "/windows/condition", "/etc/hostname");
  expect_unreadable("has its content in another file");
}

/// Damages the metadata in one place after another. Each time, reads, inspects and verifies the archive.
void use_with_damaged_metadata(const fs::path& path) {
  constexpr int stride = test::in_release(4, 15);  // only some places, because each needs a full verification
  int piece = 0;
  const std::string bytes = read_file(path);
  for (const char* signature : {"OHDR", "OCHK", "FRHP", "FHDB", "BTHD", "BTLF"})
    for (auto at = bytes.find(signature); at != std::string::npos; at = bytes.find(signature, at + 1)) {
      if (piece++ % stride != 0) continue;
      std::string damaged = bytes;
      damaged[at + 5] = static_cast<char>(damaged[at + 5] ^ 1);
      test::write_file(path, damaged);
      EXPECT_FALSE(verify_archive(path).ok());
      test::sign(path);
      try {
        inspect(path, "/");
        read_archive(path);
      } catch (const DataError&) {
      }
    }
}

TEST_F(ArchiveDamage, DamagedMetadataNeitherCrashNorPrintNowOrAtExit) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        use_with_damaged_metadata(path);
        std::exit(0);
      },
      ::testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace modebank
