// EM of Gaussian mixtures compared with other programs. All programs have the same points, start and number of
// iterations. They run on one thread, in alternating order. Prints medians of CPU time over the rounds, and compares
// log-likelihoods. Usage:
//   compare_em [ROUNDS]           with Armadillo, if the benchmark was built with it
//   compare_em memory             peak memory of N = 1e7, d = 3, K = 25 from a random start
//   compare_em serve FOLDER       for em_peers.py: writes the cases to FOLDER, then answers lines on stdin
//                                 ("case NAME", "sweep NAME THREADS KMAX RESTARTS SEED") with seconds and
//                                 log-likelihoods
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include "ident/base/seed.hpp"
#include "mixture/em.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/em_cases.hpp"

namespace modebank::bench {
namespace {

/// Largest relative difference in log-likelihood between implementations of the same algorithm.
constexpr double same = 1e-11;

/// CPU seconds of this process, which do not depend on the machine's load.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// K overlapping components, and a start that differs from them. Both are drawn in the same way as in the peers'
/// gmm_make.py.
EmCase make_case(const std::string& name, Index points, Index features, Index components, CovarianceType type,
                 int iterations) {
  auto generator = make_generator(1, "compare_em " + std::to_string(features), static_cast<std::uint64_t>(components));
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  GaussianMixture truth;
  truth.weights = Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components));
  truth.means = Eigen::MatrixXd::NullaryExpr(features, components, [&] { return uniform(generator); });
  for (Index k = 0; k < components; ++k) {
    const Eigen::MatrixXd A =
        Eigen::MatrixXd::NullaryExpr(features, features, [&] { return 0.35 * normal(generator); });
    truth.covariances.emplace_back(A * A.transpose() + 0.05 * Eigen::MatrixXd::Identity(features, features));
  }
  EmCase result{name, type, iterations, sample(truth, points, generator), truth};
  const Eigen::VectorXd mean = result.points.rowwise().mean();
  const Eigen::VectorXd variance =
      (result.points.colwise() - mean).rowwise().squaredNorm() / static_cast<double>(points);
  const double share = std::pow(static_cast<double>(components), -2.0 / static_cast<double>(features));
  for (Index k = 0; k < components; ++k) {
    result.start.means.col(k) = result.points.col(static_cast<Index>(generator() % static_cast<std::uint64_t>(points)));
    result.start.covariances[k] = (share * variance.array() + 0.05).matrix().asDiagonal();
  }
  return result;
}

std::vector<EmCase> make_cases() {
  std::vector<EmCase> cases;
  for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal}) {
    const std::string kind(name_of(type));
    cases.push_back(make_case("3000,3,8," + kind, 3000, 3, 8, type, 100));
    cases.push_back(make_case("100000,3,16," + kind, 100000, 3, 16, type, 10));
    cases.push_back(make_case("1000000,3,25," + kind, 1000000, 3, 25, type, 5));
    cases.push_back(make_case("100000,12,16," + kind, 100000, 12, 16, type, 10));
  }
  return cases;
}

EmRun run_modebank(const EmCase& problem, const Eigen::MatrixXd& errors = {}) {
  EmOptions options;
  options.covariance = problem.type;
  options.tolerance = -1.0;
  options.max_iterations = problem.iterations;
  options.covariance_floor = 1e-10;
  const double start = cpu_seconds();
  const EmResult fit = fit_em(PointSet(problem.points, detail::no_weights, errors), problem.start, options);
  const double seconds = cpu_seconds() - start;
  check(fit.iterations == problem.iterations && !fit.floor_active, "EM stopped early or met its floor");
  return {seconds, fit.log_likelihood};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void compare(const EmCase& problem, int rounds) {
  std::vector<double> own, peer;
  for (int round = 0; round < rounds; ++round) {
    const EmRun run = run_modebank(problem);
    own.push_back(run.seconds);
    if (!has_armadillo()) continue;
    const EmRun other = run_armadillo(problem);
    peer.push_back(other.seconds);
    const double difference = std::abs(run.log_likelihood / other.log_likelihood - 1.0);
    check(difference < same, fmt::format("{}: log-likelihoods differ by {}", problem.name, difference));
  }
  const double iterations = problem.iterations,
               terms = static_cast<double>(problem.points.cols() * problem.start.components());
  fmt::print("{:<24} {:>10.4f} ms/iteration {:>7.3f} ns/(point*component)", problem.name,
             1e3 * median(own) / iterations, 1e9 * median(own) / iterations / terms);
  if (!peer.empty())
    fmt::print("  Armadillo {:>10.3f} ms {:>6.1f} x", 1e3 * median(peer) / iterations, median(peer) / median(own));
  fmt::print("\n");
  std::fflush(stdout);
}

/// A different error covariance for each point, about a tenth of the components' covariances.
Eigen::MatrixXd make_errors(const EmCase& problem) {
  auto generator = make_generator(1, "compare_em errors");
  std::normal_distribution<double> normal;
  const Index F = problem.points.rows();
  Eigen::MatrixXd errors(F * F, problem.points.cols());
  for (Index i = 0; i < errors.cols(); ++i) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(F, F, [&] { return 0.1 * normal(generator); });
    Eigen::Map<Eigen::MatrixXd>(errors.col(i).data(), F, F) = A * A.transpose();
  }
  return errors;
}

void compare_errors(const EmCase& problem, int rounds) {
  const Eigen::MatrixXd errors = make_errors(problem), none = Eigen::MatrixXd::Zero(errors.rows(), errors.cols());
  std::vector<double> plain, aware;
  for (int round = 0; round < rounds; ++round) {
    plain.push_back(run_modebank(problem).seconds);
    aware.push_back(run_modebank(problem, errors).seconds);
  }
  const double difference =
      std::abs(run_modebank(problem, none).log_likelihood / run_modebank(problem).log_likelihood - 1.0);
  check(difference < same, fmt::format("error-aware EM at zero error differs by {}", difference));
  fmt::print("{:<24} error-aware {:.3f} ms/iteration, {:.2f} x plain\n", problem.name,
             1e3 * median(aware) / problem.iterations, median(aware) / median(plain));
  std::fflush(stdout);
}

/// Layout of the file: int64 N, F, K, iterations; points F x N, one point after the other; weights; means; covariances.
void write_case(const EmCase& problem, const std::string& folder) {
  std::ofstream file(folder + "/" + problem.name + ".bin", std::ios::binary);
  const std::int64_t head[4] = {problem.points.cols(), problem.points.rows(), problem.start.components(),
                                problem.iterations};
  const auto write = [&](const double* data, Index count) {
    file.write(reinterpret_cast<const char*>(data), count * static_cast<Index>(sizeof(double)));
  };
  file.write(reinterpret_cast<const char*>(head), sizeof head);
  write(problem.points.data(), problem.points.size());
  write(problem.start.weights.data(), problem.start.weights.size());
  write(problem.start.means.data(), problem.start.means.size());
  for (const Eigen::MatrixXd& covariance : problem.start.covariances) write(covariance.data(), covariance.size());
}

/// Fits every number of components up to `most`, each from `restarts` starts, with the tolerance and the iteration
/// limit of scikit-learn. Returns seconds and the sum of log-likelihoods.
EmRun sweep(const EmCase& problem, int threads, int most, int restarts, int seed) {
  EmOptions options;
  options.covariance = problem.type;
  options.restarts = restarts;
  // scikit-learn has no split-and-merge moves, so they are off
  options.split_merge = 0;
  options.tolerance = 1e-3;
  options.max_iterations = 100;
  std::vector<double> log_likelihoods(static_cast<std::size_t>(most));
  const double cpu_start = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  const EmSweep points(PointSet(problem.points), options);
  tbb::parallel_for(
      tbb::blocked_range<int>(0, most, 1),
      [&](const tbb::blocked_range<int>& range) {
        for (int i = range.begin(); i < range.end(); ++i)
          log_likelihoods[i] = points.fit(most - i, static_cast<std::uint64_t>(seed)).log_likelihood;
      },
      tbb::simple_partitioner());
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  EmRun run{threads > 1 ? wall.count() : cpu_seconds() - cpu_start, 0.0};
  for (const double value : log_likelihoods) run.log_likelihood += value;
  return run;
}

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// fit_em and all responsibilities, for a cloud of 240 MB.
void measure_memory() {
  constexpr Index count = 10000000, components = 25;
  Eigen::MatrixXd points(3, count);
  auto generator = make_generator(1, "compare_em memory");
  for (double& value : points.reshaped()) value = static_cast<double>(generator() >> 12);
  const double data = 8.0 * static_cast<double>(points.size());
  EmOptions options;
  options.restarts = 1;
  options.max_iterations = 2;
  options.split_merge = 0;
  const EmResult fit = fit_em(PointSet(points), components, options, 1);
  double sum = 0.0;
  visit_responsibilities(fit.mixture, PointSet(points), [&](Index, const auto& block) { sum += block.sum(); });
  check(std::abs(sum / static_cast<double>(count) - 1.0) < 1e-12, "responsibilities");
  fmt::print("N = 1e7, d = 3, K = 25: points {:.0f} MB, peak memory of the process {:.0f} MB = {:.2f} x\n", data / 1e6,
             peak_memory_bytes() / 1e6, peak_memory_bytes() / data);
}

void serve(const std::vector<EmCase>& cases, const std::string& folder) {
  for (const EmCase& problem : cases) {
    write_case(problem, folder);
    fmt::print("{} ", problem.name);
  }
  fmt::print("\n");
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string command, name;
    words >> command >> name;
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const EmCase& c) { return c.name == name; });
    check(found != cases.end(), "unknown case " + name);
    int threads = 1, most = 25, restarts = 5, seed = 1;
    if (command == "sweep") words >> threads >> most >> restarts >> seed;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    const EmRun own = command == "sweep" ? sweep(*found, threads, most, restarts, seed) : run_modebank(*found);
    const EmRun peer = command == "case" && has_armadillo() ? run_armadillo(*found) : EmRun{};
    fmt::print("{:.9g} {:.17g} {:.9g} {:.17g}\n", own.seconds, own.log_likelihood, peer.seconds, peer.log_likelihood);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace modebank::bench

int main(int argc, char** argv) {
  using namespace modebank::bench;
  if (argc > 1 && std::string(argv[1]) == "memory") {
    measure_memory();
    return 0;
  }
  const std::vector<EmCase> cases = make_cases();
  if (argc > 2 && std::string(argv[1]) == "serve") {
    serve(cases, argv[2]);
    return 0;
  }
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  for (const EmCase& problem : cases) compare(problem, rounds);
  for (const EmCase& problem : cases)
    if (problem.points.cols() <= 100000) compare_errors(problem, rounds);
  return 0;
}
