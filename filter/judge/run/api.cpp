// The public API of scoring: converts between plain vectors and Eigen.
#include "filter/judge/run/evaluate.hpp"
#include "ident/data/public_recording.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/judge/evaluate.hpp"

namespace modebank::judge {

namespace {

Trajectory to_internal(const filter::Bank& bank, const RecordedRun& run) {
  return to_trajectory(run, bank.measurements(), bank.inputs());
}

}  // namespace

Evaluation evaluate_run(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options,
                        std::uint64_t seed) {
  const Trajectory trajectory = to_internal(bank, run);
  RunEvaluation e = modebank::evaluate_run(bank.internal(), trajectory, options);
  draw_pit(trajectory, seed, e);
  return {to_matrix(e.prediction), to_matrix(e.innovation),  to_matrix(e.innovation_covariance),
          to_matrix(e.state),      to_matrix(e.covariance),  to_vector(e.nis),
          to_matrix(e.pit),        to_vector(e.log_density), to_matrix(e.mode_probability)};
}

double log_likelihood(const filter::Bank& bank, const RecordedRun& run, const FilterOptions& options) {
  return modebank::log_likelihood(bank.internal(), to_internal(bank, run), options);
}

}  // namespace modebank::judge
