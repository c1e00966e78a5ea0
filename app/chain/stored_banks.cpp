#include "app/chain/stored_banks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "filter/learn/from_mixture/bank.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

bool trained_on(const Recording& recording, const Trajectory& run) {
  return std::any_of(recording.runs.begin(), recording.runs.end(), [&](const Trajectory& other) {
    return other.role == Role::train && other.samples() == run.samples() && other.state == run.state &&
           other.input == run.input;
  });
}

/// Warns if the scores of a stored bank can be misread.
void warn_of_foreign_bank(const std::string& file, const Archive& stored, const Recording& recording,
                          const Tell& tell) {
  std::vector<std::string> trained;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::test && stored.recording && trained_on(*stored.recording, run)) trained.push_back(run.run);
  if (!trained.empty())
    tell(Level::warning,
         fmt::format("{}: its bank was trained on {}, so these runs are not held out and their scores are too good",
                     file, fmt::join(trained, ", ")));
  const Bank& bank = *stored.bank;
  if (bank.state_names != state_names(recording, bank.structure) ||
      bank.input_names != input_names(recording, bank.structure))
    tell(Level::warning,
         fmt::format("{}: its bank was learned from the states {} and inputs {}; the data have {} and {}", file,
                     fmt::join(bank.state_names, ", "), fmt::join(bank.input_names, ", "),
                     fmt::join(names_of(recording.states), ", "), fmt::join(names_of(recording.inputs), ", ")));
  if (const std::string remark = period_remark(file, bank, recording); !remark.empty()) tell(Level::warning, remark);
}

}  // namespace

std::string period_remark(const std::string& file, const Bank& bank, const Recording& recording) {
  constexpr double tolerated = 0.1;  // relative tolerance of the time per step, and therefore of increments
  const double dt_s = recording.median_period_s();
  if (std::abs(dt_s - bank.dt_s) <= tolerated * bank.dt_s) return "";
  return fmt::format("{}: a step of its bank is {:.4g} s, but a step of the data is {:.4g} s", file, bank.dt_s, dt_s);
}

StoredBanks read_banks(const std::filesystem::path& path, const Recording& recording, bool one_model,
                       const Tell& tell) {
  const std::string file = path.string();
  Archive stored = read_archive(path);
  if (!stored.bank) throw DataError(fmt::format("{}: this archive has no bank", file));
  const LinearStructure& structure = stored.bank->structure;
  if (structure.states != recording.state_count() || structure.inputs != recording.input_count())
    throw DataError(fmt::format("{}: its bank has {} states and {} inputs, the data have {} and {}", file,
                                structure.states, structure.inputs, recording.state_count(), recording.input_count()));
  warn_of_foreign_bank(file, stored, recording, tell);
  if (one_model && !stored.baseline && stored.bank->mode_count() > 1)
    throw DataError(fmt::format("{}: this archive has no baseline, which filter.variant = kf runs", file));
  if (one_model && stored.baseline)
    return {*stored.baseline,
            stored.baseline,
            std::move(stored.noise_only),
            {},
            {},
            std::move(stored.drifting),
            MeasuredFit::none,
            {},
            {}};
  StoredBanks banks{std::move(*stored.bank),
                    std::move(stored.baseline),
                    std::move(stored.noise_only),
                    std::move(stored.one_motion),
                    {},
                    std::move(stored.drifting),
                    MeasuredFit::none,
                    {},
                    std::move(stored.nonlinear)};
  if (one_model) return banks;
  banks.terms_asked = stored.finding && stored.finding->terms_asked;
  banks.unrefined = std::move(stored.unrefined);
  banks.measured_fit = stored.measured_fit;
  banks.left_out = std::move(stored.left_out);
  banks.mode_names = std::move(stored.mode_names);
  return banks;
}

}  // namespace modebank
