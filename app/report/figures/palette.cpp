#include "app/report/figures/palette.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/report/page/assets.hpp"

namespace modebank::app::report {
namespace {

std::string mixed(const std::string& colour, int other, double share) {
  std::string result = "#";
  for (std::size_t at = 1; at < 7; at += 2)
    result +=
        fmt::format("{:02x}", std::lround((1 - share) * std::stoi(colour.substr(at, 2), nullptr, 16) + share * other));
  return result;
}

}  // namespace

Palette palette(int modes) {
  const nlohmann::json file = nlohmann::json::parse(assets::palette_json());
  const std::vector<std::string> base = file.at("modes");
  Palette colours;
  for (std::size_t k = 0; k < static_cast<std::size_t>(modes); ++k) {
    const std::size_t round = k / base.size() % 3;
    const std::string& colour = base[k % base.size()];
    colours.modes.push_back(round == 0 ? colour : mixed(colour, round == 1 ? 0 : 255, 0.45));
  }
  colours.filters = file.at("filters");
  colours.outlier = file.at("outlier");
  return colours;
}

}  // namespace modebank::app::report
