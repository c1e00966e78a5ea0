#include "filter/bank_filter.hpp"

#include <stdexcept>
#include <string>

#include "filter/bank_filter_steps.hpp"
#include "filter/run_samples.hpp"
#include "filter/vector_imm.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

namespace {

FilterEstimate empty_estimate(const Bank& bank) {
  const Index n = bank.structure.dimension(), n_y = bank.C.rows(), K = bank.mode_count();
  FilterEstimate e;
  e.prediction.setConstant(n, not_a_number);
  e.innovation.setConstant(n_y, not_a_number);
  e.innovation_covariance.setConstant(n_y, n_y, not_a_number);
  e.state.setConstant(n, not_a_number);
  e.covariance.setConstant(n, n, not_a_number);
  e.pit.setConstant(n_y, not_a_number);
  e.mode_probability_predicted.setZero(K);
  e.mode_probability.setZero(K);
  e.nis = e.log_density = e.spread_share = not_a_number;
  return e;
}

/// Throws std::invalid_argument for numbers that no filter can work with.
void check_numbers(const Bank& bank) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("the bank's " + what);
  };
  const auto is_covariance = [](const Eigen::MatrixXd& S) {
    return S.allFinite() && (S.diagonal().array() >= 0.0).all();
  };
  require(is_covariance(bank.R), "R is no covariance");
  require(bank.C.allFinite(), "C is not finite");
  require(bank.initial_probability.allFinite() && bank.initial_probability.minCoeff() >= 0.0 &&
              bank.initial_probability.sum() > 0.0,
          "initial probabilities are none");
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    const Mode& mode = bank.modes[j];
    const std::string of_mode = " of mode " + std::to_string(j);
    require(mode.model.A.allFinite() && mode.model.B.allFinite() && mode.model.c.allFinite(),
            "model" + of_mode + " is not finite");
    require(is_covariance(mode.Q), "Q" + of_mode + " is no covariance");
  }
}

std::unique_ptr<BankFilterSteps> make_steps(const Bank& bank, const FilterOptions& options) {
  check_bank(bank);
  check_numbers(bank);
  return VectorImm::can_step(bank, options) ? make_vector_steps(bank, options) : make_general_steps(bank, options);
}

}  // namespace

BankFilterSteps::BankFilterSteps(const Bank& bank, const FilterOptions& options)
    : estimate(empty_estimate(bank)), feed(bank, options.time_steps) {}

void check_snapshot(const FilterSnapshot& snapshot, Index n, Index K) {
  if (snapshot.means.rows() != n || snapshot.means.cols() != K || snapshot.covariances.rows() != n * n ||
      snapshot.covariances.cols() != K || snapshot.mode_probability.size() != K)
    throw std::invalid_argument("the snapshot is not of a filter of " + std::to_string(K) + " modes and " +
                                std::to_string(n) + " states");
  if (!snapshot.means.allFinite() || !snapshot.covariances.allFinite() || !snapshot.mode_probability.allFinite() ||
      snapshot.mode_probability.minCoeff() < 0.0 || !(snapshot.mode_probability.sum() > 0.0) ||
      !(snapshot.noise_scale > 0.0) || !(snapshot.noise_samples >= 0.0))
    throw std::invalid_argument("the snapshot holds numbers that no filter has");
}

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options) : steps_(make_steps(bank, options)) {}

BankFilter::~BankFilter() = default;
BankFilter::BankFilter(BankFilter&&) noexcept = default;
BankFilter& BankFilter::operator=(BankFilter&&) noexcept = default;

const FilterEstimate& BankFilter::step(double time_s, const Vector& input, const Vector& measurement) {
  BankFilterSteps& s = *steps_;
  s.feed.push(time_s, input, measurement);
  if (s.started && s.feed.steps() > longest_gap_steps) s.started = false;
  if (s.started) {
    s.step(measurement);
  } else if (s.feed.can_start()) {
    s.start();
    s.started = true;
  } else {
    s.wait();
  }
  return s.estimate;
}

const FilterEstimate& BankFilter::estimate() const { return steps_->estimate; }
bool BankFilter::started() const { return steps_->started; }

void BankFilter::restart() {
  steps_->started = false;
  steps_->feed.clear();
}

FilterSnapshot BankFilter::snapshot() const {
  FilterSnapshot snapshot;
  snapshot.started = steps_->started;
  steps_->save(snapshot);
  snapshot.samples = steps_->feed.memory();
  return snapshot;
}

void BankFilter::restore(const FilterSnapshot& snapshot) {
  steps_->feed.restore(snapshot.samples);
  steps_->restore(snapshot);
  steps_->started = snapshot.started;
}

}  // namespace modebank
