#include <memory>

#include "ident/fit/detail/batch/solver.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/allocation_counter.hpp"

namespace modebank {
namespace {

using test::allocations;

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
