#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "app/pipeline.hpp"
#include "filter/bank_frame.hpp"
#include "ident/error.hpp"
#include "io/import.hpp"

namespace modebank::app {
namespace {

bool trained_on(const Recording& recording, const Trajectory& run) {
  return std::any_of(recording.runs.begin(), recording.runs.end(), [&](const Trajectory& other) {
    return other.role == Role::train && other.samples() == run.samples() && other.state == run.state &&
           other.input == run.input;
  });
}

/// What makes a stored bank's scores mean something else than they seem to.
void warn_of_foreign_bank(const std::string& file, const Archive& stored, const Recording& recording) {
  std::vector<std::string> trained;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::test && stored.recording && trained_on(*stored.recording, run)) trained.push_back(run.run);
  if (!trained.empty())
    spdlog::warn("{}: its bank was trained on {}: the scores of the test runs are not held out", file,
                 fmt::join(trained, ", "));
  const Bank& bank = *stored.bank;
  if (bank.state_names != state_names(recording, bank.structure) ||
      bank.input_names != input_names(recording, bank.structure))
    spdlog::warn("{}: its bank was learned from columns {}; {}, the data have {}; {}", file,
                 fmt::join(bank.state_names, ", "), fmt::join(bank.input_names, ", "),
                 fmt::join(names_of(recording.states), ", "), fmt::join(names_of(recording.inputs), ", "));
  constexpr double tolerated = 0.1;  // a tenth more or less time per step changes increments by as much
  if (const double dt_s = recording.median_period_s(); std::abs(dt_s - bank.dt_s) > tolerated * bank.dt_s)
    spdlog::warn("{}: its bank steps by {:.4g} s, the data by {:.4g} s", file, bank.dt_s, dt_s);
}

}  // namespace

void load_banks(const Config& config, Archive& archive) {
  Archive stored = read_archive(config.archive.bank);
  if (!stored.bank) throw DataError(fmt::format("{}: holds no bank", config.archive.bank));
  const Recording& recording = *archive.recording;
  const LinearStructure& structure = stored.bank->structure;
  if (structure.states != recording.state_count() || structure.inputs != recording.input_count())
    throw DataError(fmt::format("{}: its bank has {} states and {} inputs, the data have {} and {}",
                                config.archive.bank, structure.states, structure.inputs, recording.state_count(),
                                recording.input_count()));
  warn_of_foreign_bank(config.archive.bank, stored, recording);
  archive.provenance.inputs.push_back(describe_file(config.archive.bank));
  const bool one_model = config.filter.variant == FilterVariant::kf;  // the global one, as where banks are learned
  if (one_model && !stored.baseline && stored.bank->mode_count() > 1)
    throw DataError(fmt::format("{}: holds no baseline, which filter.variant = kf runs", config.archive.bank));
  archive.bank = one_model && stored.baseline ? stored.baseline : std::move(stored.bank);
  archive.baseline = std::move(stored.baseline);
  archive.noise_only = std::move(stored.noise_only);
  if (one_model) return;
  archive.unrefined = std::move(stored.unrefined);
  archive.measured_fit = stored.measured_fit;
}

}  // namespace modebank::app
