#include "app/text/mode_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>

#include "ident/base/characters.hpp"

namespace modebank {
namespace {

constexpr double enough = 0.6;  // smallest fraction of a mode's samples for which a label becomes the mode's name

Index samples_of(const Archive& archive, Index mode) {
  Index samples = 0;
  for (const ConfusionRow& row : archive.confusion) samples += row.mode == mode ? row.samples : 0;
  return samples;
}

/// A label that is a number could be mistaken for the number of a mode.
std::string name_by_label(const std::string& label) {
  const bool number = !label.empty() && label.find_first_not_of("+-.0123456789") == std::string::npos;
  return number ? "label " + label : label;
}

}  // namespace

std::string label_of_mode(const Archive& archive, Index mode) {
  const auto all = static_cast<double>(samples_of(archive, mode));
  for (const ConfusionRow& row : archive.confusion)
    if (row.mode == mode && row.samples > 0 && static_cast<double>(row.samples) >= enough * all) return row.label;
  return {};
}

std::vector<std::string> mode_names_of(const Archive& archive, const std::vector<std::string>& given,
                                       const Tell& tell) {
  if (!archive.bank) return {};
  const auto modes = static_cast<std::size_t>(archive.bank->mode_count());
  if (!given.empty() && given.size() != modes)
    tell(Level::warning,
         fmt::format("bank.mode_names has {} name{}, but the bank has {} mode{}: {}", given.size(),
                     given.size() == 1 ? "" : "s", modes, modes == 1 ? "" : "s",
                     given.size() < modes ? "it names only the first modes" : "its last names are not used"));
  std::vector<std::string> names(modes);
  for (std::size_t k = 0; k < modes; ++k)
    names[k] =
        k < given.size() && !given[k].empty() ? given[k] : name_by_label(label_of_mode(archive, static_cast<Index>(k)));
  const bool none = std::all_of(names.begin(), names.end(), [](const std::string& name) { return name.empty(); });
  return none ? std::vector<std::string>() : names;
}

std::string name_of_mode(const std::vector<std::string>& names, Index mode) {
  return mode < 0 || mode >= std::ssize(names) ? std::string() : one_line(names[static_cast<std::size_t>(mode)]);
}

std::string one_line(std::string name) {
  std::replace_if(name.begin(), name.end(), is_control, ' ');
  boost::algorithm::trim(name);
  return name;
}

std::string mode_cell(const std::vector<std::string>& names, Index mode) {
  const std::string name = name_of_mode(names, mode);
  return name.empty() ? std::to_string(mode) : fmt::format("{} {}", mode, name);
}

std::string mode_title(const std::vector<std::string>& names, Index mode) {
  const std::string name = name_of_mode(names, mode);
  return name.empty() ? fmt::format("mode {}", mode) : fmt::format("mode {}: {}", mode, name);
}

}  // namespace modebank
