#include "app/chain/stage_inputs.hpp"

#include "filter/learn/learn.hpp"
#include "ident/fit/fit_windows.hpp"
#include "io/import/import.hpp"

namespace modebank {
namespace {

BankInputs bank_inputs(const ChainOptions& options, const FitOptions& window) {
  BankInputs inputs{window, options.bank, options.filter.variant == FilterVariant::kf, {}};
  inputs.bank.em.seed = options.seed;
  inputs.bank.refine = refinement_asked(options.bank, is_linear(window));  // one key for what is the same
  const bool runs_the_filter = inputs.bank.refine == Refine::em || options.bank.modes > 0;
  if (runs_the_filter && !inputs.one_model) inputs.filter = options.filter;
  return inputs;
}

}  // namespace

ChainInputs chain_inputs(const ChainOptions& options) {
  FitOptions window = options.window;
  window.seed = options.seed;
  const std::string& start = options.mixture_start;
  return {{options.data},
          {window},
          {options.mixture, start, start.empty() ? "" : describe_file(start).sha256, options.seed},
          {window},
          bank_inputs(options, window),
          {window, options.filter.time_steps, options.scoring},
          {options.filter, options.scoring}};
}

}  // namespace modebank
