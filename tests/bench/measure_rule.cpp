// Measures how often the rule for additions to a model (filter/learn/left_out/rule.hpp) accepts a false and a true
// addition. Prints CSV.
//
//   measure_rule SEEDS [FIRST]     prints both tables, from seed FIRST (default 1) on
//   measure_rule worth RUNS        prints the gain of each addition on RUNS runs, at sizes near those in this file
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace {

using Eigen::Index;
using modebank::Recording;
using modebank::Refinement;

constexpr Index samples = 200;
constexpr double sd = 0.1;

/// A run of x[k+1] = a x[k] + 0.3 u[k] + w, with variables that change from step to step.
struct Step {
  double x, u, memory;  // memory: a further state that some systems have
};
using Draw = std::function<double()>;
/// Returns the next x. May change `memory`.
using Motion = std::function<double(Step&, double size, const Draw& normal, const Draw& uniform)>;

Recording simulate(const Motion& motion, double size, Index runs, int seed, double measurement_sd = 0.0) {
  std::mt19937_64 generator = modebank::make_generator(static_cast<std::uint64_t>(seed), "measure rule", 0);
  boost::random::normal_distribution<double> gauss;
  boost::random::uniform_01<double> unit;
  const Draw normal = [&] { return gauss(generator); }, uniform = [&] { return unit(generator); };
  Recording recording = modebank::test::empty_recording(1, 1);
  for (Index r = 0; r < runs; ++r) {
    Eigen::MatrixXd x(1, samples), u(1, samples);
    Step at{0.0, 0.0, 0.0};
    for (Index k = 0; k < samples; ++k) {
      if (k % 5 == 0) at.u = 2.0 * uniform() - 1.0;
      u(k) = at.u;
      x(k) = at.x + measurement_sd * normal();
      at.x = motion(at, size, normal, uniform);
    }
    modebank::test::add_run(recording, x, u);
  }
  return recording;
}

double one_motion(Step& at, double, const Draw& normal, const Draw&) { return 0.8 * at.x + 0.3 * at.u + sd * normal(); }

/// Result of one proposed addition.
struct Answer {
  double gain = 0.0, standard_error = 0.0;
  bool taken = false;
};

struct Question {
  std::string proposal;
  std::array<double, 2> sizes;  ///< sizes at which the addition gains .06 and .03 nats per sample
  std::function<Recording(double size, Index runs, int seed)> system;
  std::function<Answer(const Recording&)> ask;
};

Refinement refined(const Recording& recording, const std::function<void(modebank::RefineOptions&)>& change) {
  const modebank::WindowFits fits = modebank::test::windows_of(recording, 25, 5);
  const modebank::Bank start = modebank::learn_baseline(recording, fits.global, fits.structure).bank;
  modebank::RefineOptions options;
  options.measurement_noise = false;
  options.restarts = 0;
  change(options);
  return modebank::refine_bank(recording, fits, {start}, options, {});
}

Answer modes(const Recording& recording) {
  const Refinement r = refined(recording, [](auto& o) { o.restarts = 2, o.most_modes = 2; });
  double one = -1e300, more = -1e300, loss_of_one = 0.0;
  for (const auto& candidate : r.candidates) {
    double& best = candidate.modes == 1 ? one : more;
    if (candidate.modes == 1 && candidate.score > one) loss_of_one = candidate.loss_standard_error;
    best = std::max(best, candidate.score);
  }
  return {more - one, loss_of_one, r.bank.mode_count() > 1};
}

Answer measurement_noise(const Recording& recording) {
  const Refinement r = refined(recording, [](auto& o) { o.measurement_noise = true; });
  double exact = -1e300;
  for (const auto& candidate : r.candidates)
    if (!candidate.start.starts_with("motions")) exact = std::max(exact, candidate.score);
  return {r.measurement.score - exact, modebank::not_a_number, r.bank.R.diagonal().maxCoeff() > 1e-3 * sd * sd};
}

Answer state_dependent_transition(const Recording& recording) {
  const Refinement r =
      refined(recording, [](auto& o) { o.restarts = 2, o.most_modes = 2, o.state_dependent_transition = true; });
  return {r.switching.gain, r.switching.gain_standard_error, !r.bank.transition_logit.empty()};
}

std::vector<Question> questions() {
  const auto of = [](Motion motion) {
    return [=](double size, Index runs, int seed) { return simulate(motion, size, runs, seed); };
  };
  const Motion two_modes = [](Step& at, double size, const Draw& normal, const Draw& uniform) {
    if (at.memory == 0.0 || uniform() < 0.02) at.memory = at.memory > 0.0 ? -1.0 : 1.0;
    return 0.8 * at.x + (0.3 + size * at.memory) * at.u + sd * normal();
  };
  const Motion border = [](Step& at, double size, const Draw& normal, const Draw&) {
    return 0.8 * at.x + (at.x > 0.0 ? 0.3 + size : 0.3 - size) * at.u + sd * normal();
  };
  const auto measured = [](double size, Index runs, int seed) { return simulate(one_motion, 0.0, runs, seed, size); };
  return {{"modes", {0.081, 0.061}, of(two_modes), modes},
          {"measurement noise", {0.22, 0.155}, measured, measurement_noise},
          {"transitions by state", {0.069, 0.046}, of(border), state_dependent_transition}};
}

void print_worth(Index runs) {
  for (const Question& q : questions())
    for (const double scale : {1.0, 0.85, 1.15})
      for (const double base : q.sizes) {
        const double size = scale * base;
        fmt::print("{}, size {:.4f}: {:.4f}\n", q.proposal, size, q.ask(q.system(size, runs, 1000)).gain);
        std::fflush(stdout);
      }
}

void print_seed(int seed) {
  constexpr std::array<Index, 2> runs{6, 12};
  for (const Question& q : questions()) {
    const auto row = [&](double worth, Index count, const Recording& recording) {
      const Answer answer = q.ask(recording);
      fmt::print("{},{},{},{},{:.5f},{:.5f},{:d}\n", q.proposal, worth, count, seed, answer.gain, answer.standard_error,
                 answer.taken ? 1 : 0);
    };
    row(0.0, runs[0], simulate(one_motion, 0.0, 0.0, runs[0], seed));
    row(0.06, runs[0], q.system(q.sizes[0], runs[0], seed));
    row(0.03, runs[1], q.system(q.sizes[1], runs[1], seed));
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "worth") {
    print_worth(std::atoi(argv[2]));
    return 0;
  }
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 60, first = argc > 2 ? std::atoi(argv[2]) : 1;
  fmt::print("proposal,worth,runs,seed,gain,standard_error,taken\n");
  for (int seed = first; seed < first + seeds; ++seed) print_seed(seed);
}
