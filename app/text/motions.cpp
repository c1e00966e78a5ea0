#include "app/text/motions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "app/text/mode_names.hpp"
#include "filter/step/motions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

/// Mean stay in a motion. The stay of each mode gives its rate of switches. The transition matrix gives the fraction of
/// these switches that leave the motion.
void set_stay(const Bank& bank, const std::vector<UsedMode>& modes, Motion& motion) {
  if (modes.size() == 1) {
    motion.stay_s = modes.front().stay_s;
    motion.at_least = modes.front().at_least;
    return;
  }
  const Eigen::MatrixXd& T = bank.transition.matrix();
  double use = 0.0, left = 0.0;
  for (const UsedMode& mode : modes) {
    if (!(mode.stay_s > 0.0)) continue;
    double inside = 0.0, any = 0.0;
    for (Index j = 0; j < T.cols(); ++j) {
      if (j == mode.mode) continue;
      any += T(mode.mode, j);
      if (bank.motion_of(j) == motion.number) inside += T(mode.mode, j);
    }
    use += mode.use;
    left += any > 0.0 ? mode.use / mode.stay_s * (1.0 - inside / any) : 0.0;
    motion.at_least = motion.at_least || mode.at_least;
  }
  motion.stay_s = left > 0.0 ? use / left : not_a_number;
}

Motion motion_with(const Bank& bank, const std::vector<std::string>& names, Index number,
                   const std::vector<UsedMode>& modes) {
  Motion motion;
  motion.number = number;
  motion.name = name_of_mode(names, modes.front().mode);
  for (const UsedMode& mode : modes) {
    motion.modes.push_back(mode.mode);
    motion.use += mode.use;
    if (name_of_mode(names, mode.mode) != motion.name) motion.name.clear();
  }
  set_stay(bank, modes, motion);
  const ModeDynamics dynamics = mode_dynamics(bank, motion.modes.front());
  if (!dynamics.decays.empty()) motion.slowest = dynamics.decays.front();
  motion.slowest.frequency_hz = 0.0;  // each mode's own row has the period
  motion.gain = dynamics.gain;
  motion.gain_error = dynamics.gain_error;
  return motion;
}

/// What the modes of the motions are, such as "each calm and rough". Empty unless all motions have equally many modes,
/// more than one.
std::string levels_in_words(const Bank& bank, Index motions) {
  const Index levels = bank.mode_count() / motions;
  for (Index motion = 0; motion < motions; ++motion)
    if (std::count(bank.motion.begin(), bank.motion.end(), motion) != levels) return "";
  const std::string words = levels == 2 ? "calm and rough" : fmt::format("at {} noise levels", levels);
  return (motions == 1 ? ": " : ": each ") + words;
}

}  // namespace

std::string Motion::title() const {
  if (modes.size() == 1) return name.empty() ? "mode " + numbers() : fmt::format("mode {}: {}", numbers(), name);
  return name.empty() ? "modes " + numbers() : fmt::format("{} (modes {})", name, numbers());
}

std::string Motion::numbers(std::size_t most) const {
  const auto shown = static_cast<std::ptrdiff_t>(std::min(modes.size(), most));
  return fmt::format("{}{}", fmt::join(modes.begin(), modes.begin() + shown, ", "), modes.size() > most ? ", .." : "");
}

std::vector<Motion> motions_of(const Bank& bank, const std::vector<std::string>& names,
                               const std::vector<UsedMode>& modes) {
  std::vector<Motion> motions;
  for (Index number = 0; number < motion_count(bank); ++number) {
    std::vector<UsedMode> own;
    std::copy_if(modes.begin(), modes.end(), std::back_inserter(own),
                 [&](const UsedMode& mode) { return bank.motion_of(mode.mode) == number; });
    motions.push_back(motion_with(bank, names, number, own));
  }
  std::stable_sort(motions.begin(), motions.end(), [](const Motion& a, const Motion& b) { return a.use > b.use; });
  return motions;
}

std::vector<Motion> motions_of(const Archive& archive) {
  return motions_of(*archive.bank, archive.mode_names, used_modes(archive));
}

Index told_of(const std::vector<Motion>& motions) {
  constexpr Index most = 8;
  constexpr double least_use = 0.01;
  const Index worth =
      std::count_if(motions.begin(), motions.end(), [](const Motion& motion) { return motion.use >= least_use; });
  return std::clamp<Index>(worth, 1, most);
}

std::string counted_words(const Bank& bank) {
  const Index counted = counted_motions(bank);
  const char* const noun = counted == bank.mode_count() ? "mode" : "motion";
  return fmt::format("{} {}{}", counted, noun, counted == 1 ? "" : "s");
}

std::string motion_words(const Bank& bank) {
  const Index motions = motion_count(bank), modes = bank.mode_count(), passages = motions - counted_motions(bank);
  std::string text = counted_words(bank);
  if (passages > 0) text += passages == 1 ? " and a passage" : fmt::format(" and {} passages", passages);
  if (motions == modes) return passages == 0 ? text : fmt::format("{} ({} modes)", text, modes);
  return fmt::format("{} ({} modes{})", text, modes, levels_in_words(bank, motions));
}

}  // namespace modebank::app
