#include "app/cli/log/same_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

std::string name_of_first(const FileSet& set) { return printable_name(typed_path(set.files.front())); }

/// Time span that two tables have in common, and the duration of each table [s].
struct Overlap {
  double common_s, shorter_s, longer_s;
};

/// The common time of the states' and the inputs' file, if both are single files with times.
std::optional<Overlap> overlap_of(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed,
                                  const Guess& guess) {
  if (guess.inputs.empty() || guess.inputs.front().file == guess.states.front().file) return std::nullopt;
  double first_s = -HUGE_VAL, last_s = HUGE_VAL, shorter_s = HUGE_VAL, longer_s = 0.0;
  const std::int64_t origin_ns = surveyed[guess.states.front().file].tables[guess.states.front().table].origin_ns;
  for (const ChannelPlace& place : {guess.states.front(), guess.inputs.front()}) {
    const SurveyedTable& table = surveyed[place.file].tables[place.table];
    if (sets[place.file].files.size() != 1 || table.time.empty()) return std::nullopt;
    const double offset_s = static_cast<double>(table.origin_ns - origin_ns) / 1e9;
    const double from_s = offset_s + table.time_s.minCoeff<Eigen::PropagateNumbers>(),
                 to_s = offset_s + table.time_s.maxCoeff<Eigen::PropagateNumbers>();
    first_s = std::max(first_s, from_s);
    last_s = std::min(last_s, to_s);
    shorter_s = std::min(shorter_s, to_s - from_s);
    longer_s = std::max(longer_s, to_s - from_s);
  }
  return Overlap{std::max(0.0, last_s - first_s), shorter_s, longer_s};
}

[[noreturn]] void refuse(const FileSet& a, const FileSet& b, const std::string& reason) {
  throw ConfigurationError(
      fmt::format("{} and {} have different columns, and are not two instruments of the same "
                  "runs{}: name logs of one kind, or for each run both files",
                  name_of_first(a), name_of_first(b), reason));
}

}  // namespace

void refuse_other_runs(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed,
                       const Guess& guess) {
  std::set<std::size_t> used;
  for (const auto* places : {&guess.states, &guess.inputs})
    for (const ChannelPlace& place : *places) used.insert(place.file);
  const FileSet &states = sets[guess.states.front().file],
                &inputs = guess.inputs.empty() ? states : sets[guess.inputs.front().file];
  const bool other_runs =
      states.files.size() != inputs.files.size() ||
      (states.files.size() > 1 && !states.pattern.empty() && !inputs.pattern.empty() && states.runs != inputs.runs);
  if (other_runs) refuse(states, inputs, "");
  for (std::size_t i = 0; i < sets.size(); ++i)
    if (used.count(i) == 0) refuse(states, sets[i], "");
  constexpr double least_share = 0.5;
  if (const auto overlap = overlap_of(sets, surveyed, guess))
    if (overlap->common_s < least_share * overlap->shorter_s)
      refuse(states, inputs,
             fmt::format(" (of the shorter one's {:.4g} s they have {:.4g} s in common)", overlap->shorter_s,
                         overlap->common_s));
}

std::string doubt_of_one_run(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed,
                             const Guess& guess) {
  const auto overlap = overlap_of(sets, surveyed, guess);
  if (!overlap) return {};
  return fmt::format(
      "{} and {} are taken for two instruments of one run: they have {:.4g} s in common, and last {:.4g} and {:.4g} s",
      name_of_first(sets[guess.states.front().file]), name_of_first(sets[guess.inputs.front().file]), overlap->common_s,
      overlap->shorter_s, overlap->longer_s);
}

}  // namespace modebank::app
