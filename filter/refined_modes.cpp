#include "filter/refined_modes.hpp"

#include "filter/bank_frame.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

Bank with_modes(const Bank& frame, const SwitchingRegression& model) {
  Bank bank = frame;
  bank.modes.clear();
  const Index p = bank.structure.parameters(), K = model.modes();
  for (Index j = 0; j < K; ++j)
    bank.modes.push_back(make_mode(bank.structure, model.theta.col(j), model.Q[static_cast<std::size_t>(j)],
                                   Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Constant(p, not_a_number),
                                   1.0 / static_cast<double>(K)));
  bank.transition = TransitionMatrix(model.transition);
  bank.initial_probability = model.initial;
  return bank;
}

}  // namespace modebank
