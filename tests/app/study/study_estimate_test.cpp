#include "app/study/run/study_estimate.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "app/config/config_file.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using namespace modebank::app;

/// A study of 3 mixtures x 2 filters = 6 runs, with two runs at a time, whose log and archives the tests make up.
class StudyEstimates : public CliTest {
 protected:
  StudyEstimates() {
    config = load_config(CliTest::config(), {{"study.output", file("s").string()},
                                             {"study.jobs", "2"},
                                             {"study.vary", "mixture.components = 1 | 2 | 3"},
                                             {"study.vary", "filter.variant = imm | salvi2025"}});
    Provenance provenance;
    provenance.modebank_version = "1";
    plan = make_plan(config, provenance);
  }
  void make_archive(std::size_t row, std::size_t bytes) const {
    write("s/trials/" + plan.table.rows[row].key + ".h5", std::string(bytes, 'x'));
  }
  StudyEstimate estimate() const {
    return estimate_study({config, {}, TrialStore(file("s")), plan.table.varied_keys, "1", {}, {}}, plan,
                          Sampling::what_is_there);
  }
  std::string line(std::size_t row, const std::string& rest) const {
    return "2026-01-01T00:00:00Z,host,1," + plan.table.rows[row].key + rest + "\n";
  }

  Config config;
  StudyPlan plan;
};

TEST_F(StudyEstimates, CountSharedStagesOnceForEachOfTheirInputs) {
  std::filesystem::create_directories(file("s/trials"));
  make_archive(0, 1000);
  make_archive(1, 3000);
  // Of one mixture, the second with all but its filter at hand: seconds, then data, lags, windows, mixture,
  // competitors, bank, competitors' scores, bank's scores.
  write("s/log.csv", line(0, ",done,10,1,0,4,2,0.5,1,0.5,0.7,") + line(1, ",done,2,0,0,0,0,0,0,0.5,0.9,") +
                         line(2, ",failed,70,0,0,0,0,0,0,0,\"no, not one\"") + line(3, ",done,5,1,") +
                         "2026-01-01T00:00:00Z,host,1,another,done,99,9,9,9,9,9,9,9,9,\n");
  const StudyEstimate found = estimate();
  EXPECT_EQ(found.left, 4u);
  EXPECT_TRUE(found.known);
  EXPECT_DOUBLE_EQ(found.bytes, 4 * 2000.0);
  // Both processes read the data; one fit of the windows, with all competitors' seconds; three mixtures and banks; and
  // six times what is left of 12 s without the stages' 11.1, with the bank's scores (1.6), for two runs.
  const double all = 2 * 1.0 + (4 + 0.5 + 0.5 + 0.5) + 3 * 2.0 + 3 * 1.0 + 3 * (12.0 - 11.1 + 1.6);
  EXPECT_NEAR(found.seconds, all * 4 / 6 / 2, 1e-12);
  EXPECT_NE(found.basis.find("from 2 runs made before, 2 to 10 s each"), std::string::npos) << found.basis;
}

TEST_F(StudyEstimates, WithoutALogPromiseNoTime) {
  std::filesystem::create_directories(file("s/trials"));
  make_archive(0, 1000);
  EXPECT_FALSE(estimate().known);
  EXPECT_EQ(estimate().left, 5u);
}

}  // namespace
}  // namespace modebank::test
