#include "app/study/stage_inputs.hpp"

#include <algorithm>
#include <vector>

#include "app/option_table.hpp"
#include "io/import.hpp"

namespace modebank::app {
namespace {

/// Key prefixes that a stage reads itself, and the stages whose results it starts from.
struct Reads {
  std::vector<std::string> keys;
  std::vector<TrialStage> stages;
};

Reads reads_of(TrialStage stage, const Config& config) {
  using enum TrialStage;
  switch (stage) {
    case data:
      return {{"data."}, {}};
    case windows:
      return {{"window.", "job.seed"}, {data}};
    case competitors:
      return {{}, {windows}};
    case mixture:
      return {{"mixture.", "job.seed"}, {windows}};
    case bank:
      // Refinement maximises the likelihood of the configured filter; else only kf says which bank it is.
      return {{"bank.", "job.seed", config.bank.refine == Refine::em ? "filter." : "filter.variant = kf"},
              {mixture, competitors}};
    case competitor_scores:
      return {{"filter.time_steps", "filter.horizon", "filter.smooth"}, {competitors}};
    case bank_scores:
      return {{"filter."}, {bank}};
  }
  return {};
}

}  // namespace

std::string stage_inputs(TrialStage stage, const Config& config, const std::string& data_hash) {
  const Reads reads = reads_of(stage, config);
  std::string text = stage == TrialStage::data ? "data_hash = " + data_hash + "\n" : "";
  for (const TrialStage earlier : reads.stages) text += stage_inputs(earlier, config, data_hash);
  for (const Option& option : option_table())
    if (std::any_of(reads.keys.begin(), reads.keys.end(),
                    [&](const std::string& prefix) { return option.key.rfind(prefix, 0) == 0; }))
      text += option.key + " = " + option.get(config) + "\n";
  if (stage == TrialStage::bank && config.filter.variant == FilterVariant::kf) text += "filter.variant = kf\n";
  if (stage == TrialStage::mixture && !config.mixture.start_file.empty())
    text += "mixture.start content = " + describe_file(config.mixture.start_file).sha256 + "\n";
  return text;
}

}  // namespace modebank::app
