// The exported C code on all held-out samples of a demo and of real robots, with unchanged configurations.
#include <fmt/format.h>

#include "app/cli/live_filter.hpp"
#include "app/config/config_file.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/app/export/exported.hpp"

namespace modebank::test {
namespace {

using app::test::Differences;

class ExportedCOfRobots : public CliTest {
 protected:
  void simulate(const std::string& configuration) const {
    const std::string path = (project_dir() / "configs" / configuration).string();
    ASSERT_EQ(modebank({"simulate", path, "--simulate.output", file("data").string()}).status, 0);
  }

  void learn(const std::string& configuration, const std::vector<std::string>& options) const {
    std::vector<std::string> words{"run", (project_dir() / "configs" / configuration).string(), "--archive.output",
                                   archive()};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramResult result = modebank(words);
    ASSERT_EQ(result.status, 0) << result.err;
  }

  void expect_same() const {
    const Archive stored = read_archive(archive());
    const app::Config config = app::stored_config(stored.config, {});
    const app::ExportedBank exported = app::exported_bank(stored, archive(), "bank", app::tracked_options(config), 0.0);
    std::vector<Trajectory> held_out;
    Index samples = 0;
    for (const Trajectory& run : stored.recording->runs)
      if (run.role == Role::test) {
        held_out.push_back(run);
        samples += run.transitions();
      }
    const Differences worst = app::test::differences_of_c(exported, held_out);
    EXPECT_LE(worst.mean, 1e-9);
    EXPECT_LE(worst.probability, 1e-9);
    EXPECT_LE(worst.ahead, 1e-9);
    EXPECT_GT(worst.compared, samples - 20 * std::ssize(held_out));
    fmt::print("{} samples, means within {:.2g} predicted standard deviations, probabilities within {:.2g}\n",
               worst.compared, worst.mean, worst.probability);
  }
};

TEST_F(ExportedCOfRobots, Demo) {
  simulate("simulate_demo.ini");
  // A bank whose noise depends on the inputs cannot be exported.
  learn("demo.ini", {"--data.root", file("data").string(), "--bank.measurement_variance", "1e-6"});
  expect_same();
}

TEST_F(ExportedCOfRobots, Ice) {
  MODEBANK_NEEDS_SHARED_DATA();
  learn("husky_ice.ini", {"--data.root", shared_data_dir().string()});
  expect_same();
}

TEST_F(ExportedCOfRobots, Drive) {
  MODEBANK_NEEDS_SHARED_DATA();
  learn("drive_husky.ini", {"--data.root", shared_data_dir().string()});
  expect_same();
}

}  // namespace
}  // namespace modebank::test
