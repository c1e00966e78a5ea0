#include "app/report/page/run_families.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/report/page/folded_transition.hpp"
#include "app/report/page/numbers.hpp"
#include "app/text/mode_words.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// A mean over several modes is shown with its standard error. A single mode is shown as in its own row.
json time_cell(const ModeFamily& family, bool unidentifiable, const std::string& unit) {
  const Decay& slowest = family.slowest;
  if (unidentifiable) return number(NAN, not_identifiable);
  if (family.counted.size() > 1 && std::isfinite(slowest.time_constant_s))
    return number(slowest.time_constant_s,
                  estimate_text(slowest.time_constant_s, slowest.time_constant_error_s) + " " + unit);
  return number(slowest.time_constant_s, decay_words(slowest, "±", unit));
}

json gains_cells(const ModeFamily& family, const std::vector<bool>& unidentifiable) {
  json cells = json::array();
  for (Index i = 0; i < family.gain.rows(); ++i)
    for (Index j = 0; j < family.gain.cols(); ++j) {
      const bool is_unidentifiable = unidentifiable[static_cast<std::size_t>(i * family.gain.cols() + j)];
      cells.push_back(is_unidentifiable ? number(NAN, not_identifiable)
                                        : estimate(family.gain(i, j), family.gain_error(i, j)));
    }
  return cells;
}

std::vector<std::vector<Index>> told_groups(const std::vector<ModeFamily>& families) {
  std::vector<std::vector<Index>> groups;
  for (Index f = 0; f < told_families(families); ++f) groups.push_back(families[static_cast<std::size_t>(f)].modes);
  return groups;
}

}  // namespace

json families_of(const Archive& archive, const std::vector<ModeFamily>& families, const std::string& unit) {
  const LinearStructure& structure = archive.bank->structure;
  const std::vector<bool> unidentifiable = unidentifiable_gains(archive, structure);
  json list = json::array();
  for (const ModeFamily& family : families) {
    const UsedMode stay{family.modes.front(), family.use, family.stay_s, family.at_least};
    list.push_back({{"title", family.title()},
                    {"name", family.name},
                    {"modes", family.modes},
                    {"use", number(family.use, fmt::format("{:.1f} %", 100 * family.use))},
                    {"stay", number(family.stay_s, stay_words(stay, unit))},
                    {"decays", time_cell(family, unidentifiable_decays(archive, structure), unit)},
                    {"gains", gains_cells(family, unidentifiable)}});
  }
  return list;
}

Index told_families(const std::vector<ModeFamily>& families) {
  std::vector<double> use;
  for (const ModeFamily& family : families) use.push_back(family.use);
  return told_of(use);
}

json folded_transition_of(const Bank& bank, const std::vector<ModeFamily>& families) {
  Eigen::VectorXd use(bank.mode_count());
  for (const ModeFamily& family : families)
    for (std::size_t i = 0; i < family.modes.size(); ++i) use(family.modes[i]) = family.uses[i];
  const Eigen::MatrixXd folded = folded_transition(bank.transition.matrix(), told_groups(families), use);
  json rows = json::array();
  for (Index i = 0; i < folded.rows(); ++i) {
    rows.push_back(json::array());
    for (const double probability : folded.row(i)) rows.back().push_back(number(probability));
  }
  return rows;
}

json label_section(const Archive& archive, const std::vector<ModeFamily>& families) {
  if (archive.confusion.empty()) return nullptr;
  const std::vector<Index> family = family_of_modes(families);
  const auto told = static_cast<std::size_t>(told_families(families));
  struct Label {
    std::string name;
    Index samples = 0;
    std::vector<double> shares;  // one share per family with its own row, then the share of all others
  };
  std::vector<Label> labels;
  for (const ConfusionRow& row : archive.confusion) {
    if (labels.empty() || labels.back().name != row.label)
      labels.push_back({row.label, 0, std::vector<double>(told + 1, 0.0)});
    labels.back().samples += row.samples;
    const auto f = static_cast<std::size_t>(family[static_cast<std::size_t>(row.mode)]);
    labels.back().shares[std::min(f, told)] += row.share;
  }
  json rows = json::array();
  for (const Label& label : labels) {
    rows.push_back({{"label", label.name}, {"samples", count(label.samples)}, {"shares", json::array()}});
    for (const double share : label.shares) rows.back()["shares"].push_back(percent(share));
  }
  return {{"role", name_of(archive.confusion.front().role)}, {"rows", rows}};
}

}  // namespace modebank::app::report
