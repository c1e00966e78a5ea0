#include "app/text/mode_families.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "app/text/mode_names.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

using Eigen::VectorXd;

constexpr double near_errors = 2.0;  // largest distance of near modes, in standard errors of the difference

/// Numbers by which families differ: a mode's slowest time constant, then the gains that the data determine.
struct ModeNumbers {
  ModeDynamics dynamics;
  VectorXd values, errors;
  bool oscillates = false, vague = false;
};

/// Whether some state has no gain that exceeds its standard error. The data then do not determine the response of this
/// state.
bool has_vague_response(const ModeDynamics& dynamics, const UnidentifiableNumbers& unidentifiable) {
  const Index states = dynamics.gain.rows(), inputs = dynamics.gain.cols();
  for (Index i = 0; i < states; ++i) {
    bool any = false, told = false;
    for (Index j = 0; j < inputs; ++j) {
      if (unidentifiable.gains[static_cast<std::size_t>(i * inputs + j)]) continue;
      any = true;
      told = told || std::abs(dynamics.gain(i, j)) > dynamics.gain_error(i, j);
    }
    if (any && !told) return true;
  }
  return false;
}

ModeNumbers numbers_of_mode(const Bank& bank, Index mode, const UnidentifiableNumbers& unidentifiable) {
  ModeNumbers numbers{mode_dynamics(bank, mode), {}, {}, false, false};
  const ModeDynamics& dynamics = numbers.dynamics;
  std::vector<double> values, errors;
  if (!unidentifiable.decays && !dynamics.decays.empty()) {
    const Decay& slowest = dynamics.decays.front();
    values.push_back(slowest.time_constant_s);
    errors.push_back(slowest.time_constant_error_s);
    numbers.oscillates = slowest.frequency_hz > 0.0;
    // A mode with time constant zero dies out at once. A mode with a negative or infinite time constant never settles.
    numbers.vague = !(values[0] >= 0.0 && std::isfinite(values[0])) || std::isnan(errors[0]) || errors[0] > values[0];
  }
  for (Index i = 0; i < dynamics.gain.rows(); ++i)
    for (Index j = 0; j < dynamics.gain.cols(); ++j) {
      if (unidentifiable.gains[static_cast<std::size_t>(i * dynamics.gain.cols() + j)]) continue;
      values.push_back(dynamics.gain(i, j));
      errors.push_back(dynamics.gain_error(i, j));
    }
  numbers.values = Eigen::Map<const VectorXd>(values.data(), std::ssize(values));
  numbers.errors = Eigen::Map<const VectorXd>(errors.data(), std::ssize(errors));
  numbers.vague = numbers.vague || values.empty() || !numbers.values.allFinite() || !numbers.errors.allFinite() ||
                  has_vague_response(dynamics, unidentifiable);
  return numbers;
}

/// The largest difference between the numbers of two modes, in standard errors; infinite if the modes cannot belong to
/// one family.
double apart(const ModeNumbers& a, const ModeNumbers& b) {
  if (a.vague || b.vague || a.oscillates != b.oscillates) return std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (Index i = 0; i < a.values.size(); ++i) {
    const double difference = std::abs(a.values(i) - b.values(i));
    if (difference > 0.0) most = std::max(most, difference / std::hypot(a.errors(i), b.errors(i)));
  }
  return most;
}

/// Joins the two nearest groups repeatedly, until no two groups are near. The distance of groups is that of their
/// farthest members.
void join_near(std::vector<std::vector<Index>>& groups, const std::vector<ModeNumbers>& numbers) {
  const auto farthest = [&](const std::vector<Index>& a, const std::vector<Index>& b) {
    double most = 0.0;
    for (const Index i : a)
      for (const Index j : b)
        most = std::max(most, apart(numbers[static_cast<std::size_t>(i)], numbers[static_cast<std::size_t>(j)]));
    return most;
  };
  while (true) {
    double least = near_errors;
    std::size_t first = 0, second = 0;
    for (std::size_t a = 0; a < groups.size(); ++a)
      for (std::size_t b = a + 1; b < groups.size(); ++b)
        if (const double between = farthest(groups[a], groups[b]); between < least || (between == least && second == 0))
          least = between, first = a, second = b;
    if (second == 0) return;
    groups[first].insert(groups[first].end(), groups[second].begin(), groups[second].end());
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

/// Groups the modes by name. Modes without a name are grouped by their numbers.
std::vector<std::vector<Index>> groups_of(const std::vector<std::string>& names,
                                          const std::vector<ModeNumbers>& numbers) {
  std::map<std::string, std::vector<Index>> named;
  std::vector<std::vector<Index>> groups;
  for (Index k = 0; k < std::ssize(numbers); ++k)
    if (const std::string name = name_of_mode(names, k); !name.empty())
      named[name].push_back(k);
    else
      groups.push_back({k});
  join_near(groups, numbers);
  for (const auto& [name, modes] : named) groups.push_back(modes);
  return groups;
}

/// Mean stay in a family. The stay of each mode gives its rate of switches. The transition matrix gives the fraction of
/// these switches that leave the family.
void set_stay(const Bank& bank, const std::vector<UsedMode>& modes, ModeFamily& family) {
  if (modes.size() == 1) {
    family.stay_s = modes.front().stay_s;
    family.at_least = modes.front().at_least;
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
      if (std::find(family.modes.begin(), family.modes.end(), j) != family.modes.end()) inside += T(mode.mode, j);
    }
    use += mode.use;
    left += any > 0.0 ? mode.use / mode.stay_s * (1.0 - inside / any) : 0.0;
    family.at_least = family.at_least || mode.at_least;
  }
  family.stay_s = left > 0.0 ? use / left : not_a_number;
}

/// Sets the family's means, and the modes that enter these means.
void set_numbers(const std::vector<ModeNumbers>& numbers, ModeFamily& family) {
  const auto of = [&](Index k) -> const ModeNumbers& { return numbers[static_cast<std::size_t>(k)]; };
  std::vector<double> weights;
  const bool all = std::all_of(family.modes.begin(), family.modes.end(), [&](Index k) { return of(k).vague; });
  for (std::size_t i = 0; i < family.modes.size(); ++i) {
    if (!all && of(family.modes[i]).vague) continue;
    family.counted.push_back(family.modes[i]);
    weights.push_back(family.uses[i]);
  }
  const ModeDynamics& first = of(family.counted.front()).dynamics;
  if (!first.decays.empty()) family.slowest = first.decays.front();
  family.gain = first.gain;
  family.gain_error = first.gain_error;
  if (family.counted.size() == 1) return;
  const Eigen::Map<const VectorXd> w(weights.data(), std::ssize(weights));
  const auto pooled = [&](auto value, auto error) {
    VectorXd values(w.size()), errors(w.size());
    for (Index i = 0; i < w.size(); ++i) {
      const ModeDynamics& dynamics = of(family.counted[static_cast<std::size_t>(i)]).dynamics;
      values(i) = value(dynamics);
      errors(i) = error(dynamics);
    }
    return pooled_number(values, errors, w);
  };
  if (!first.decays.empty()) {
    const auto time = pooled([](const ModeDynamics& d) { return d.decays.front().time_constant_s; },
                             [](const ModeDynamics& d) { return d.decays.front().time_constant_error_s; });
    const auto left = pooled([](const ModeDynamics& d) { return d.decays.front().per_sample; },
                             [](const ModeDynamics&) { return 0.0; });
    family.slowest = {left.value, time.value, 0.0, time.error};
  }
  for (Index i = 0; i < family.gain.rows(); ++i)
    for (Index j = 0; j < family.gain.cols(); ++j) {
      const auto gain = pooled([&](const ModeDynamics& d) { return d.gain(i, j); },
                               [&](const ModeDynamics& d) { return d.gain_error(i, j); });
      family.gain(i, j) = gain.value;
      family.gain_error(i, j) = gain.error;
    }
}

}  // namespace

VectorXd shares_of(const VectorXd& weights) {
  const double sum = weights.sum();
  const auto count = static_cast<double>(weights.size());
  return sum > 0.0 ? VectorXd(weights / sum) : VectorXd(VectorXd::Constant(weights.size(), 1.0 / count));
}

PooledNumber pooled_number(const VectorXd& values, const VectorXd& errors, const VectorXd& weights) {
  const VectorXd w = shares_of(weights);
  const double mean = w.dot(values);
  const double variance = w.dot(errors.cwiseAbs2()) + w.dot((values.array() - mean).square().matrix());
  return {mean, std::sqrt(variance)};
}

std::string ModeFamily::title() const {
  if (modes.size() == 1) return name.empty() ? "mode " + numbers() : fmt::format("mode {}: {}", numbers(), name);
  return name.empty() ? "modes " + numbers() : fmt::format("{} (modes {})", name, numbers());
}

std::string ModeFamily::numbers(std::size_t most) const {
  std::string text;
  for (std::size_t i = 0; i < std::min(modes.size(), most); ++i) text += (i > 0 ? ", " : "") + std::to_string(modes[i]);
  return text + (modes.size() > most ? ", .." : "");
}

std::vector<ModeFamily> mode_families(const Bank& bank, const std::vector<std::string>& names,
                                      const std::vector<UsedMode>& modes, const UnidentifiableNumbers& unidentifiable) {
  std::vector<ModeNumbers> numbers;
  for (Index k = 0; k < bank.mode_count(); ++k) numbers.push_back(numbers_of_mode(bank, k, unidentifiable));
  std::vector<ModeFamily> families;
  for (const std::vector<Index>& group : groups_of(names, numbers)) {
    ModeFamily family;
    std::vector<UsedMode> members;
    for (const UsedMode& mode : modes) {
      if (std::find(group.begin(), group.end(), mode.mode) == group.end()) continue;
      members.push_back(mode);
      family.modes.push_back(mode.mode);
      family.uses.push_back(mode.use);
      family.use += mode.use;
    }
    family.name = name_of_mode(names, group.front());
    set_stay(bank, members, family);
    set_numbers(numbers, family);
    families.push_back(std::move(family));
  }
  const auto place = [&](const ModeFamily& family) {
    return std::find_if(modes.begin(), modes.end(),
                        [&](const UsedMode& mode) { return mode.mode == family.modes.front(); }) -
           modes.begin();
  };
  std::sort(families.begin(), families.end(), [&](const ModeFamily& a, const ModeFamily& b) {
    return a.use != b.use ? a.use > b.use : place(a) < place(b);
  });
  return families;
}

std::vector<ModeFamily> mode_families(const Archive& archive) {
  const LinearStructure& structure = archive.bank->structure;
  return mode_families(*archive.bank, archive.mode_names, used_modes(archive),
                       {unidentifiable_decays(archive, structure), unidentifiable_gains(archive, structure)});
}

std::vector<Index> family_of_modes(const std::vector<ModeFamily>& families) {
  std::size_t count = 0;
  for (const ModeFamily& family : families) count += family.modes.size();
  std::vector<Index> of(count, 0);
  for (std::size_t f = 0; f < families.size(); ++f)
    for (const Index mode : families[f].modes) of[static_cast<std::size_t>(mode)] = static_cast<Index>(f);
  return of;
}

}  // namespace modebank::app
