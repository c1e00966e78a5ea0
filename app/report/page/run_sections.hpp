#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/page_arrays.hpp"
#include "io/archive/archive.hpp"

/// Sections of a run's page; each is null if the archive lacks its data.
namespace modebank::app::report {

/// Level of bands, regions and bounds in drawings.
inline constexpr double drawn_level = 0.95;

nlohmann::json origin_section(const Archive& archive);
/// Content of the first screen, in the same words and numbers (screen_facts.hpp), with a picture.
nlohmann::json verdict_section(const Archive& archive);
/// A small picture of the judged runs: the first state in the colour of the most probable mode, and known labels. It is
/// drawn before the rest of the page is read.
nlohmann::json picture_of(const Archive& archive);

/// Samples per bucket in the finest drawing of a run's signals: for data and bank, and for all other filters.
struct Detail {
  Index finest = 1, finest_others = 1;
};
/// Indices of the runs that the page draws and lists one by one: the first hundred of each role.
std::vector<std::size_t> drawn_runs(const Recording& recording);
/// Signals of these runs over time, with each filter's evaluation.
nlohmann::json runs_section(const Archive& archive, PageArrays& arrays, const Detail& detail);
/// Largest possible size of these signals in the page, without outliers [bytes].
std::size_t most_signal_bytes(const Archive& archive, const Detail& detail);
/// The same signals, in the finest detail that fits into `most` bytes.
nlohmann::json affordable_runs_section(const Archive& archive, PageArrays& arrays, std::size_t bytes);

nlohmann::json windows_section(const Archive& archive, PageArrays& arrays);
nlohmann::json selection_section(const Archive& archive);
nlohmann::json bank_section(const Archive& archive);
nlohmann::json filter_section(const Archive& archive);

}  // namespace modebank::app::report
