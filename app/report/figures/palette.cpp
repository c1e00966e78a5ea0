#include "app/report/figures/palette.hpp"

#include <nlohmann/json.hpp>

#include "app/report/page/assets.hpp"

namespace modebank::app::report {

Palette palette() {
  const nlohmann::json file = nlohmann::json::parse(assets::palette_json());
  return {file.at("modes"), file.at("outlier"), file.at("filters")};
}

}  // namespace modebank::app::report
