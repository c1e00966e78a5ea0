#include "ident/base/not_a_number.hpp"
#include "ident/check/run_check.hpp"
#include "ident/check/stream_check.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd noise(Index count, std::uint64_t seed, double sd = 1.0) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal(0.0, sd);
  return VectorXd::NullaryExpr(count, [&](Index) { return normal(generator); });
}

TEST(CheckSampling, CountsWhatIsWrongWithTimes) {
  Stream stream{VectorXd::LinSpaced(101, 0.0, 10.0), noise(101, 1).transpose()};
  const SamplingCheck clean = check_sampling(stream);
  EXPECT_NEAR(clean.rate_hz, 10.0, 1e-9);
  EXPECT_NEAR(clean.jitter, 0.0, 1e-9);
  EXPECT_EQ(clean.gaps + clean.repeated_times + clean.backward_times + clean.missing_samples, 0);
  stream.time_s(20) = stream.time_s(19);            // a repeated time
  std::swap(stream.time_s(40), stream.time_s(41));  // two swapped times: one step back
  stream.time_s(60) = not_a_number;
  stream.values(0, 70) = not_a_number;
  stream.time_s.tail(20).array() += 3.0;
  const SamplingCheck found = check_sampling(stream);
  EXPECT_EQ(found.repeated_times, 1);
  EXPECT_EQ(found.backward_times, 1);
  EXPECT_EQ(found.missing_times, 1);
  EXPECT_EQ(found.missing_samples, 1);
  EXPECT_EQ(found.gaps, 1);
  EXPECT_NEAR(found.longest_gap_s, 3.1, 1e-9);
  EXPECT_NEAR(found.duration_s, 13.0, 1e-9);
  EXPECT_EQ(in_order(stream).time_s.size(), 99);
}

TEST(CheckChannel, FindsTheStepOfStampsFarFromZero) {
  Eigen::VectorXd stamps(400);
  for (Eigen::Index k = 0; k < stamps.size(); ++k) stamps(k) = 1.7e9 + 0.25 * static_cast<double>(k);
  EXPECT_DOUBLE_EQ(check_channel(stamps).quantum, 0.25);
  EXPECT_EQ(check_channel(stamps).levels, 400);
}

TEST(CheckChannel, FindsTheQuantumAlsoWhenNoTwoLevelsAreNeighbours) {
  const VectorXd smooth = noise(2000, 2);
  EXPECT_EQ(check_channel(smooth).quantum, 0.0);
  const VectorXd coarse = (smooth.array() * 127.0 / 4.0).round() / 127.0;
  EXPECT_NEAR(check_channel(coarse).quantum, 1.0 / 127.0, 1e-6);
  const VectorXd offset = coarse.array() + 0.1234;
  EXPECT_NEAR(check_channel(offset).quantum, 1.0 / 127.0, 1e-6);
  EXPECT_NEAR(check_channel((VectorXd(6) << 0, 0.2, 0.5, 0.5, 0.9, 1.4).finished()).quantum, 0.1, 1e-9);
  const ChannelCheck levels = check_channel((VectorXd(5) << 1, 1, 2, 2, 1).finished());
  EXPECT_EQ(levels.levels, 2);
  EXPECT_EQ(levels.repeated, 0.5);
}

TEST(Spikes, AreCountedInNoiseButNotInOscillation) {
  VectorXd signal = VectorXd::NullaryExpr(4000, [](Index k) { return std::sin(0.05 * static_cast<double>(k)); });
  signal += noise(4000, 3, 0.02);
  EXPECT_EQ(spikes(signal, 0.0), 0);
  for (Index k = 50; k < 4000; k += 100) signal(k) += k % 200 == 50 ? 1.0 : -1.0;
  EXPECT_EQ(spikes(signal, 0.0), 40);
  const VectorXd steps = VectorXd::NullaryExpr(4000, [](Index k) { return k / 500 % 2 == 0 ? 0.0 : 1.0; });
  EXPECT_EQ(spikes(steps, 0.0), 0) << "a step is no spike";
}

TEST(Saturation, IsAPileUpAtFullScale) {
  const VectorXd smooth = noise(20000, 4);
  EXPECT_FALSE(std::isfinite(saturation_limits({smooth}).high));
  const SaturationLimits both = saturation_limits({smooth.cwiseMin(1.5).cwiseMax(-1.5)});
  EXPECT_NEAR(both.high, 1.5, 0.07);
  EXPECT_NEAR(both.low, -1.5, 0.07);
  EXPECT_FALSE(both.soft);
  const SaturationLimits upper = saturation_limits({smooth.cwiseMin(1.5).cwiseMax(-0.5)});
  EXPECT_FALSE(std::isfinite(upper.low)) << "far from full scale: a rest, not a limit";
}

/// A test signal of random held levels has few levels. So by chance more of its levels may lie near one end.
TEST(Saturation, IsNotSeenInHeldRandomLevels) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 generator(seed);
    std::vector<VectorXd> runs;
    double level = 1.0;
    for (int run = 0; run < 12; ++run)
      runs.push_back(VectorXd::NullaryExpr(400, [&] {
        if (generator() % 5 == 0) level = 3.4 * static_cast<double>(generator() >> 11) * 0x1p-53 - 1.7;
        return level;
      }));
    const SaturationLimits limits = saturation_limits(runs);
    EXPECT_FALSE(std::isfinite(limits.low) || std::isfinite(limits.high)) << seed;
    const SaturationLimits alone = saturation_limits({runs.front()});
    EXPECT_FALSE(std::isfinite(alone.low) || std::isfinite(alone.high)) << seed << ", one run";
  }
  const SaturationLimits tube = saturation_limits({(1.2 * noise(20000, 8)).array().tanh().matrix()});
  EXPECT_TRUE(tube.soft) << "a soft limiter pushes what is large towards the end of the range";
}

TEST(Saturation, IsNotSeenInSignalsOfFewLevels) {
  std::mt19937_64 generator(5);
  const auto held = [&](std::vector<double> levels, double sd) {
    VectorXd signal = noise(4000, 6, sd);
    double level = levels.front();
    for (Index k = 0; k < signal.size(); ++k) {
      if (generator() % 5 == 0) level = levels[generator() % levels.size()];
      signal(k) += level;
    }
    return signal;
  };
  for (const double sd : {0.0, 0.02}) {  // levels first as commanded, then as measured
    const VectorXd binary = held({-1.0, 1.0}, sd);
    EXPECT_TRUE(has_two_levels(binary));
    EXPECT_FALSE(std::isfinite(saturation_limits({binary}).high));
    EXPECT_FALSE(std::isfinite(saturation_limits({binary}).low));
    EXPECT_EQ(check_channel(binary).outliers, 0) << "a pulse of one sample";
  }
  for (const std::vector<double>& levels : {std::vector<double>{-1.0, 0.0, 1.0}, {0.0, 1.0, 2.0, 3.0, 4.0}}) {
    EXPECT_FALSE(has_two_levels(held(levels, 0.0)));
    EXPECT_FALSE(std::isfinite(saturation_limits({held(levels, 0.0)}).high));
  }
  EXPECT_TRUE(std::isfinite(saturation_limits({held({0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, 0.0)}).high))
      << "three times as common as what lies inside";
  VectorXd glitch = held({0.0, 1.0}, 0.01);
  glitch(70) = 50.0;
  EXPECT_TRUE(has_two_levels(glitch));
  EXPECT_FALSE(has_two_levels(noise(4000, 7)));
}

TEST(Rest, RepeatsNothingThatMoves) {
  constexpr Index N = 400;
  Stream states{VectorXd::LinSpaced(N, 0.0, 39.9), noise(N, 8).transpose()}, inputs = states;
  for (Index k = 0; k < N; ++k) {
    const bool rests = k < 100 || k >= 300;
    inputs.values(0, k) = rests ? 0.0 : 1.0;
    if (rests) states.values(0, k) = 0.0;
  }
  for (Index k = 110; k < 160; k += 10)
    states.values(0, k) = states.values(0, k - 1);  // five repeated values among two hundred samples in motion
  const VectorXd level = VectorXd::Constant(1, 0.01), state = states.values.row(0);
  const std::vector<bool> rests = resting_samples(states, inputs, level);
  EXPECT_EQ(std::count(rests.begin(), rests.end(), true), 99 + 99);
  EXPECT_NEAR(check_channel(state).repeated, (5.0 + 198.0) / 399.0, 1e-12);
  EXPECT_NEAR(repeats_in_motion(state, rests), 5.0 / 201.0, 1e-12);
  inputs.values.setOnes();
  EXPECT_NEAR(repeats_in_motion(state, resting_samples(states, inputs, level)), 203.0 / 399.0, 1e-12)
      << "a state that repeats while an input acts is measured coarsely";
  const Stream none{states.time_s, MatrixXd(0, N)};
  EXPECT_EQ(repeats_in_motion(state, resting_samples(states, none, VectorXd(0))), 203.0 / 399.0);
}

TEST(CheckCommands, StillnessAndConstancy) {
  Stream inputs{VectorXd::LinSpaced(10, 0.0, 9.0), MatrixXd(2, 10)};
  inputs.values << 0, 0, 1, 1, 1, 1, 0, 0, 2, 2,  //
      0, 0, 1, 1, 1, 2, 0, 0, 2, 2;
  const CommandCheck check = check_commands(inputs, Eigen::Vector2d(0.01, 0.01));
  EXPECT_DOUBLE_EQ(check.still, 0.4);
  EXPECT_DOUBLE_EQ(check.longest_constant_s, 2.0);
  EXPECT_DOUBLE_EQ(check.changes, 4.0 / 9.0);
}

TEST(CheckRest, MeasuresTheBiasWhereInputsAreStill) {
  Stream states{VectorXd::LinSpaced(1001, 0.0, 10.0), MatrixXd(1, 1001)}, inputs = states;
  for (Index k = 0; k <= 1000; ++k) {
    const bool rests = k >= 300 && k < 800;
    inputs.values(0, k) = rests ? 0.0 : 1.0;
    states.values(0, k) = rests && k >= 340 ? 0.02 : 1.0;  // the vehicle comes to rest within the ignored half second
  }
  const RestCheck rest = check_rest(states, inputs, VectorXd::Constant(1, 0.01));
  EXPECT_NEAR(rest.mean(0), 0.02, 1e-12);
  EXPECT_NEAR(rest.sd(0), 0.0, 1e-9);
  EXPECT_NEAR(rest.duration_s, 4.49, 0.02);
  inputs.values.setOnes();
  EXPECT_TRUE(std::isnan(check_rest(states, inputs, VectorXd::Constant(1, 0.01)).mean(0)));
}

TEST(ExcitationOrder, OfKnownSignals) {
  constexpr Index N = 2000;
  const auto signal = [](auto f) { return MatrixXd(Eigen::RowVectorXd::NullaryExpr(N, f)); };
  EXPECT_EQ(excitation_order(signal([](Index) { return 0.7; })), 1) << "a constant tells one number";
  EXPECT_EQ(excitation_order(signal([](Index k) { return std::sin(0.9 * static_cast<double>(k)); })), 2);
  EXPECT_EQ(excitation_order(signal([](Index k) {
              return std::sin(0.9 * static_cast<double>(k)) + std::sin(2.1 * static_cast<double>(k));
            })),
            4);
  EXPECT_EQ(excitation_order(noise(N, 5).transpose()), 10);
  MatrixXd proportional(2, N);
  proportional.row(0) = noise(N, 6).transpose();
  proportional.row(1) = -proportional.row(0);
  EXPECT_EQ(excitation_order(proportional), 0);
  EXPECT_EQ(excitation_order(MatrixXd::Zero(1, N)), 0);
}

Trajectory driven_run(Index samples, Index hold) {
  MatrixXd input(2, samples), state(1, samples);
  const VectorXd left = noise(samples, 7), right = noise(samples, 8), w = noise(samples, 9, 0.05);
  double x = 0.0;
  for (Index k = 0; k < samples; ++k) {
    const Index command = k / hold * hold;
    input.col(k) << left(command), right(command);
    state(0, k) = x;
    x += -0.3 * x - 0.4 * input(0, k) + 0.5 * input(1, k) + w(k);
  }
  return make_run(state, input);
}

TEST(DeficientWindows, AreThoseWithinOneCommand) {
  const Trajectory run = driven_run(401, 40);
  // In 31 of every 40 possible starts, a window of 10 transitions lies within one command of 40 samples. Two held
  // inputs are then collinear.
  const DeficientWindows windows = count_deficient_windows(run, 10, skid_structure);
  EXPECT_EQ(windows.windows, 391);
  EXPECT_EQ(windows.deficient, 310);
  EXPECT_EQ(count_deficient_windows(driven_run(401, 1), 10, skid_structure).deficient, 0);
}

}  // namespace
}  // namespace modebank::test
