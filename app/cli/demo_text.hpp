#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/text/screen_facts.hpp"
#include "io/archive/archive.hpp"

/// Compares the modes that `modebank demo` found with the true modes of the simulated system.
namespace modebank::app {

/// A number of a mode, with the true number of the mode's ground.
struct FoundNumber {
  std::string name, unit;
  double found = 0.0, error = 0.0;  ///< error: standard error of `found`; NaN if unknown
  double truth = 0.0;
};

/// A mode of the bank, with the most frequent ground of the mode's samples.
struct FoundGround {
  std::string ground;  ///< empty if no ground has more than half of the samples
  Index mode = 0;
  std::vector<FoundNumber> numbers;  ///< the mode's time constant, gains and noise
};

/// The most used mode is first. Only a mode with a ground has numbers.
struct DemoFindings {
  std::vector<FoundGround> modes;
  std::size_t grounds = 0;  ///< in truth
  double agreement = 0.0;   ///< share of held-out samples for which the most probable mode has the sample's ground
};

/// Whether the archive and the system can be compared. The system must be linear, with one state and named grounds. The
/// archive must have one bank with the same channels, scored on labelled runs.
bool is_comparable(const Archive& archive, const Config& simulation);
DemoFindings compare_with_truth(const Archive& archive, const Config& simulation);

/// The comparison as text: 14 lines for two modes.
std::string demo_text(const Archive& archive, const DemoFindings& findings, const Settings& settings);
/// The comparison as JSON: `agreement` and `modes`, see docs/reference/json.md.
nlohmann::json demo_json(const DemoFindings& findings);

}  // namespace modebank::app
