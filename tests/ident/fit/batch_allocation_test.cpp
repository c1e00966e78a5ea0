#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <memory>

#include "ident/batch_solver.hpp"
#include "tests/ident/ident_test_support.hpp"

// A program of its own, since it replaces these for all of its code: whatever takes memory, Eigen and operator new
// included, comes through here.
namespace {
std::atomic<long> allocations = 0;
}  // namespace

#ifdef __SANITIZE_ADDRESS__
extern "C" void __sanitizer_malloc_hook(const volatile void* /*memory*/, std::size_t /*bytes*/) { ++allocations; }
extern "C" void __sanitizer_free_hook(const volatile void* /*memory*/) {}
#else
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) noexcept {
  ++allocations;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_calloc(count, bytes);
}
void* realloc(void* memory, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_realloc(memory, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) noexcept {
  ++allocations;
  *memory = __libc_memalign(alignment, bytes);
  return *memory ? 0 : ENOMEM;
}
}
#endif

namespace modebank {
namespace {

TEST(BatchSolverMemory, TheCounterSeesEigenAndOperatorNew) {
  const long before = allocations;
  const Eigen::VectorXd vector = Eigen::VectorXd::Ones(100);
  const long eigen = allocations;
  const auto owned = std::make_unique<std::array<double, 100>>();
  EXPECT_GT(eigen, before);
  EXPECT_GT(allocations, eigen);
  EXPECT_EQ(vector(3), 1.0 + (*owned)[3]);
}

TEST(BatchSolverMemory, NothingIsAllocatedOnceTheWorkspaceIsLargeEnough) {
  std::mt19937_64 generator(2);
  const Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, 4000, generator);
  for (const Loss loss : {Loss::trivial, Loss::huber, Loss::tukey}) {
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
