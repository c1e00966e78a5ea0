#include "ident/fit/whitened_problem.hpp"

#include <vector>

namespace modebank {

namespace {

/// The block of state i: the rows of U for its samples, the rows for its prior, and its part of the basis.
struct StateBlock {
  Eigen::MatrixXd U_samples;
  Eigen::MatrixXd U_prior;
  Eigen::MatrixXd basis;
};

StateBlock block_without_prior(const Decomposition& d, double sigma) {
  return {d.U, Eigen::MatrixXd(0, d.rank()), d.basis * sigma};
}

StateBlock block_with_prior(const Transitions& t, double sigma, const Eigen::VectorXd& prior_sd) {
  const Index L = t.count(), q = t.regressors.cols();
  Eigen::MatrixXd stacked(L + q, q);
  stacked.topRows(L) = t.regressors / sigma;
  stacked.bottomRows(q) = prior_sd.cwiseInverse().asDiagonal();
  const Decomposition d = decompose(stacked, 0.0);
  return {d.U.topRows(L), d.U.bottomRows(q), d.basis};
}

/// Moves the origin to the least-squares solution. A second pass removes the rounding errors that remain in b.
void centre(WhitenedProblem& problem) {
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd z = problem.J.transpose() * problem.b;
    problem.origin += problem.basis * z;
    problem.b -= problem.J * z;
  }
}

}  // namespace

WhitenedProblem whiten(const Transitions& t, const Decomposition& decomposition, const Eigen::VectorXd& sigma,
                       const ParameterPrior* prior) {
  const Index L = t.count(), n = t.increments.cols(), q = t.regressors.cols();
  std::vector<StateBlock> blocks;
  Index unknowns = 0;
  for (Index i = 0; i < n; ++i) {
    blocks.push_back(prior ? block_with_prior(t, sigma(i), prior->sd.segment(i * q, q))
                           : block_without_prior(decomposition, sigma(i)));
    unknowns += blocks.back().basis.cols();
  }

  WhitenedProblem problem{L, n, {}, {}, {}, prior ? prior->mean : Eigen::VectorXd::Zero(n * q)};
  const Index rows = L * n + (prior ? n * q : 0);
  problem.J = RowMajorMatrix::Zero(rows, unknowns);
  problem.b = Eigen::VectorXd::Zero(rows);
  problem.basis = Eigen::MatrixXd::Zero(n * q, unknowns);
  Index column = 0;
  for (Index i = 0; i < n; ++i) {
    const StateBlock& block = blocks[static_cast<std::size_t>(i)];
    const Index r = block.basis.cols();
    const Eigen::VectorXd increments = t.increments.col(i) - t.regressors * problem.origin.segment(i * q, q);
    for (Index k = 0; k < L; ++k) {
      problem.J.block(k * n + i, column, 1, r) = block.U_samples.row(k);
      problem.b(k * n + i) = increments(k) / sigma(i);
    }
    if (prior) problem.J.block(L * n + i * q, column, q, r) = block.U_prior;
    problem.basis.block(i * q, column, q, r) = block.basis;
    column += r;
  }
  centre(problem);
  return problem;
}

}  // namespace modebank
