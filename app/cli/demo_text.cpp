#include "app/cli/demo_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/text/judged_runs.hpp"
#include "app/text/mode_names.hpp"
#include "app/text/mode_words.hpp"
#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app {
namespace {

constexpr int demo_columns = 100;

/// The simulated ground as a bank of one mode. The same functions can then compute the true and the estimated numbers.
Bank true_bank(const Config& simulation, std::size_t ground) {
  const SimulationOptions& system = simulation.simulate.system;
  const auto inputs = static_cast<Index>(simulation.data.input.size());
  const Eigen::VectorXd& theta = system.modes[ground];
  const double sd = system.process_sd[system.process_sd.size() == 1 ? 0 : ground];
  Bank bank = one_mode_bank({1, inputs, theta.size() == inputs + 2}, theta, Eigen::VectorXd::Constant(1, sd * sd));
  bank.dt_s = 1.0 / simulation.simulate.rate_hz;
  return bank;
}

/// Standard error of the standard deviation of the process noise, from the standard error of its variance.
double noise_error(const Mode& mode, double sd) {
  return mode.Q_standard_error.size() > 0 ? mode.Q_standard_error(0, 0) / (2.0 * sd) : not_a_number;
}

/// Time constant, gains and noise of a mode, each with the true number of the mode's ground.
std::vector<FoundNumber> numbers_beside(const Archive& archive, Index mode, const Bank& truth) {
  const Bank& bank = *archive.bank;
  const ModeDynamics found = mode_dynamics(bank, mode), real = mode_dynamics(truth, 0);
  const Channel& state = archive.recording->states.front();
  const Decay& slowest = found.decays.front();
  std::vector<FoundNumber> numbers{{"time constant", "s", slowest.time_constant_s, slowest.time_constant_error_s,
                                    real.decays.front().time_constant_s}};
  for (Index i = 0; i < found.gain.cols(); ++i) {
    const Channel& input = archive.recording->inputs[static_cast<std::size_t>(i)];
    numbers.push_back({fmt::format("{} per {}", state.name, input.name), unit_ratio(state.unit, input.unit),
                       found.gain(0, i), found.gain_error(0, i), real.gain(0, i)});
  }
  const Mode& of_bank = bank.modes[static_cast<std::size_t>(mode)];
  const double sd = std::sqrt(of_bank.Q(0, 0));
  numbers.push_back(
      {"noise per step", state.unit, sd, noise_error(of_bank, sd), std::sqrt(truth.modes.front().Q(0, 0))});
  return numbers;
}

/// For each mode, the most frequent ground among its samples.
std::vector<std::string> grounds_of_modes(const Archive& archive) {
  std::vector<std::string> grounds;
  for (Index mode = 0; mode < archive.bank->mode_count(); ++mode) grounds.push_back(label_of_mode(archive, mode));
  return grounds;
}

double agreement_of(const Archive& archive) {
  const std::vector<std::string> grounds = grounds_of_modes(archive);
  Index all = 0, alike = 0;
  for (const ConfusionRow& row : archive.confusion) {
    all += row.samples;
    alike += grounds[static_cast<std::size_t>(row.mode)] == row.label ? row.samples : 0;
  }
  return static_cast<double>(alike) / static_cast<double>(all);
}

/// One line per number: "grip time constant 0.1507 +- 0.0006 s true 0.150".
std::string ground_rows(const FoundGround& mode) {
  std::string text, label = mode.ground;
  for (const FoundNumber& number : mode.numbers) {
    const std::string found =
        fmt::format("{}{} {}", number.found < 0.0 ? "" : " ", estimate_text(number.found, number.error), number.unit);
    text += fmt::format("  {:<6}{:<17}{:<36}true {: .3f}\n", label, number.name, found, number.truth);
    label.clear();
  }
  return mode.ground.empty() ? fmt::format("  mode {} is on no ground for most of its samples\n", mode.mode) : text;
}

/// States how much better the modes predict. Without evidence for the modes, returns the finding of the first screen
/// instead.
std::string worth_text(const FirstScreen& screen) {
  if (screen.answer != Answer::evidence) return wrapped("finding   " + screen.finding, demo_columns) + "\n";
  return fmt::format("With these modes each held-out sample is {:.2g} times as likely as with one linear model ({}).\n",
                     std::exp(screen.gain), screen.competitor);
}

}  // namespace

bool is_comparable(const Archive& archive, const Config& simulation) {
  const SimulateConfig& system = simulation.simulate;
  if (system.ground_names.empty()) return false;
  if (!archive.bank || !archive.labels || !archive.recording || archive.confusion.empty()) return false;
  return names_of(archive.recording->states) == simulation.data.state &&
         names_of(archive.recording->inputs) == simulation.data.input && simulation.data.state.size() == 1;
}

DemoFindings compare_with_truth(const Archive& archive, const Config& simulation) {
  const std::vector<std::string>& names = simulation.simulate.ground_names;
  const std::vector<std::string> grounds = grounds_of_modes(archive);
  DemoFindings findings{{}, names.size(), agreement_of(archive)};
  for (const UsedMode& used : used_modes(archive)) {
    const std::string& ground = grounds[static_cast<std::size_t>(used.mode)];
    const auto name = std::find(names.begin(), names.end(), ground);
    FoundGround& found = findings.modes.emplace_back(FoundGround{ground, used.mode, {}});
    if (name != names.end())
      found.numbers = numbers_beside(
          archive, used.mode, true_bank(simulation, static_cast<std::size_t>(std::distance(names.begin(), name))));
  }
  return findings;
}

std::string demo_text(const Archive& archive, const DemoFindings& findings, const Settings& settings) {
  const FirstScreen screen = make_first_screen(archive, settings);
  const std::size_t modes = findings.modes.size();
  std::string text =
      fmt::format("Found {} mode{} on {} grounds. A mode is one way in which {} answers; +- is one standard error.\n",
                  modes, modes == 1 ? "" : "s", findings.grounds, archive.recording->states.front().name);
  for (const FoundGround& mode : findings.modes) text += ground_rows(mode);
  text += fmt::format("{:.1f} % of the {} samples are assigned to their true ground.\n", 100.0 * findings.agreement,
                      words_for(screen.role));
  text += worth_text(screen);
  if (std::isfinite(screen.coverage))
    text += fmt::format("{:.1f} % of the held-out samples lie in the predicted 95 % band (92.5 to 97.5 % is good).\n",
                        100.0 * screen.coverage);
  if (!screen.warning.empty()) text += wrapped("warning   " + screen.warning, demo_columns) + "\n";
  return text;
}

nlohmann::json demo_json(const DemoFindings& findings) {
  nlohmann::json modes = nlohmann::json::array();
  for (const FoundGround& mode : findings.modes) {
    nlohmann::json numbers = nlohmann::json::array();
    for (const FoundNumber& number : mode.numbers)
      numbers.push_back({{"name", number.name},
                         {"unit", number.unit},
                         {"found", number.found},
                         {"error", number.error},
                         {"truth", number.truth}});
    modes.push_back({{"mode", mode.mode}, {"ground", mode.ground}, {"numbers", numbers}});
  }
  return {{"agreement", findings.agreement}, {"modes", modes}};
}

}  // namespace modebank::app
