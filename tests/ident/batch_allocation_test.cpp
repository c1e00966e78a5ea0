#include <atomic>
#include <cstdlib>
#include <new>

#include "ident/batch_solver.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace {
std::atomic<long> allocations = 0;
}  // namespace

// A program of its own, since it replaces these for all of its code.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* memory = std::malloc(bytes ? bytes : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace modebank {
namespace {

TEST(BatchSolverMemory, NothingIsAllocatedOnceTheWorkspaceIsLargeEnough) {
  std::mt19937_64 generator(2);
  const Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, 4000, generator);
  for (const Loss loss : {Loss::huber, Loss::tukey}) {
    FitOptions options;
    options.loss = loss;
    const ParameterPrior prior{test::skid_theta, Eigen::Vector3d::Ones()};
    const BatchSolver solver(batch_settings(test::skid_structure, options, &prior, 1e-4));
    BatchWorkspace workspace;
    std::vector<batch::Verdict> verdict(2000);
    Eigen::MatrixXd theta(3, 2000);
    batch::Output out;
    out.verdict = verdict.data();
    out.theta = theta.data();
    const auto solve = [&](Index windows) {
      const batch::Chunk chunk = workspace.stage(run, 0, windows, test::skid_structure, solver.settings());
      solver(chunk, workspace.scratch(options.length), out);
    };
    solve(2000);
    for (const Index windows : {200, 2000}) {
      const long before = allocations;
      solve(windows);
      EXPECT_EQ(allocations - before, 0) << windows << " windows, " << name_of(loss);
    }
    EXPECT_EQ(std::count(verdict.begin(), verdict.end(), batch::Verdict::solved), 2000);
  }
}

}  // namespace
}  // namespace modebank
