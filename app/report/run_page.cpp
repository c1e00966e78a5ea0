#include "app/report/run_page.hpp"

#include <fmt/format.h>

#include "app/report/assets.hpp"
#include "app/report/run_sections.hpp"

namespace modebank::app::report {

Page run_page(const Archive& archive, const std::string& file, const ReportConfig& /*options*/) {
  Page page;
  page.title = fmt::format("{} · modebank", file);
  page.script = assets::run_js();
  page.data = {
      {"kind", "run"}, {"file", file}, {"origin", origin_section(archive)}, {"verdict", verdict_section(archive)}};
  return page;
}

}  // namespace modebank::app::report
