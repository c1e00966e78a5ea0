#include "app/report/page/run_page.hpp"

#include <fmt/format.h>

#include "app/report/page/assets.hpp"
#include "app/report/page/run_sections.hpp"

namespace modebank::app::report {

namespace {

/// The signals may use the part of the page's size limit that the fixed parts and the windows leave, but at least this.
constexpr std::size_t least_signal_bytes = 1'000'000;

std::size_t room_for_signals(const Page& page, const ReportConfig& options) {
  constexpr double bytes_per_MB = 1e6;
  constexpr std::size_t tables = 1'000'000;
  const std::size_t taken = page.script.size() + page.arrays.bytes() + tables;
  const auto allowed = static_cast<std::size_t>(options.size_mb * bytes_per_MB);
  return std::max(least_signal_bytes, allowed > taken ? allowed - taken : 0);
}

}  // namespace

Page run_page(const Archive& archive, const std::string& file, const ReportConfig& options) {
  Page page;
  page.title = fmt::format("{} · modebank", file);
  page.script = assets::run_js();
  page.data = {{"kind", "run"},
               {"file", file},
               {"origin", origin_section(archive)},
               {"verdict", verdict_section(archive)},
               {"windows", windows_section(archive, page.arrays)},
               {"selection", selection_section(archive)},
               {"bank", bank_section(archive)},
               {"filter", filter_section(archive)}};
  page.data["data"] = affordable_runs_section(archive, page.arrays, room_for_signals(page, options));
  return page;
}

}  // namespace modebank::app::report
