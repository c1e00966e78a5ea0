#include <gtest/gtest.h>

#include <string>

#include "tests/ident/fit/coverage_study.hpp"

namespace modebank {
namespace {

constexpr std::ptrdiff_t windows = 5000;  // number of windows at which the standard error of a share is 0.003

/// The range of coverage that docs/results/simulated.md promises for a case.
struct Promise {
  CoverageCase which;
  CovarianceKind kind;
  double low, high;
};

class Coverage : public ::testing::TestWithParam<Promise> {};

TEST_P(Coverage, OfTheRegionIsAsPromised) {
  const Promise promise = GetParam();
  for (const Loss loss : {Loss::trivial, Loss::huber}) {
    const double share = test::measure_coverage(promise.which, loss, promise.kind, windows);
    EXPECT_GE(share, promise.low) << name_of(loss);
    EXPECT_LE(share, promise.high) << name_of(loss);
    ::testing::Test::RecordProperty(std::string(name_of(loss)), std::to_string(share));
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Coverage,
                         ::testing::Values(Promise{CoverageCase::gaussian, CovarianceKind::model, 0.93, 0.97},
                                           Promise{CoverageCase::poor, CovarianceKind::model, 0.93, 0.97},
                                           Promise{CoverageCase::outliers, CovarianceKind::sandwich, 0.88, 0.97},
                                           Promise{CoverageCase::growing_noise, CovarianceKind::sandwich, 0.88, 0.97},
                                           // At L = 25 HC3 loses some accuracy, also in cases that do not need it.
                                           Promise{CoverageCase::gaussian, CovarianceKind::sandwich, 0.88, 0.97},
                                           Promise{CoverageCase::poor, CovarianceKind::sandwich, 0.93, 0.97}),
                         [](const auto& instance) {
                           return std::string(name_of(instance.param.which)) + "_" +
                                  std::string(name_of(instance.param.kind));
                         });

/// The reason for the sandwich covariance: if noise grows with |x|, the coverage of `model` falls below its promised
/// range.
TEST(ModelCovariance, IsShortWhereTheNoiseDependsOnTheState) {
  for (const Loss loss : {Loss::trivial, Loss::huber})
    EXPECT_LT(test::measure_coverage(CoverageCase::growing_noise, loss, CovarianceKind::model, windows), 0.90);
}

}  // namespace
}  // namespace modebank
