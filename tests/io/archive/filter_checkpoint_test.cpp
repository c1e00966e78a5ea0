// Checkpoints that another program changed.
#include "io/archive/filter_checkpoint.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(FilterCheckpoint, D16ACheckpointThatWasChangedIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path checkpoint = folder.path() / "checkpoint.json";
  FilterSnapshot snapshot;
  snapshot.started = true;
  snapshot.means = Eigen::MatrixXd::Constant(1, 2, -0.0164);
  snapshot.covariances = Eigen::MatrixXd::Constant(1, 2, 0.25);
  snapshot.mode_probability = Eigen::Vector2d(0.25, 0.75);
  snapshot.samples.inputs = Eigen::MatrixXd::Zero(2, 1);
  snapshot.samples.measurements = Eigen::MatrixXd::Zero(1, 1);
  save_checkpoint(checkpoint, "one", snapshot);
  EXPECT_EQ(load_checkpoint(checkpoint, "one").means, snapshot.means);
  EXPECT_THAT([&] { load_checkpoint(checkpoint, "two"); }, ThrowsMessage<DataError>(HasSubstr("another bank")));
  std::string text = read_file(checkpoint);
  text.replace(text.find("-0.0164"), 2, "-9");
  write_file(checkpoint, text);
  EXPECT_THAT([&] { load_checkpoint(checkpoint, "one"); },
              ThrowsMessage<DataError>(HasSubstr("its SHA-256 does not match")));
}

}  // namespace
}  // namespace modebank::test
