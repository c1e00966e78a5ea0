#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/page_arrays.hpp"
#include "io/archive/archive.hpp"

/// The parts of a run's page, each null where the archive does not hold what it shows.
namespace modebank::app::report {

/// Of the bands, regions and bounds that the page draws.
inline constexpr double drawn_level = 0.95;

nlohmann::json origin_section(const Archive& archive);
/// What the first screen says, with the same words and numbers (screen_facts.hpp), and its picture.
nlohmann::json verdict_section(const Archive& archive);
/// The judged runs in little: the first state by the mode that is most probable, and what is known of the ground. Small
/// enough to be drawn before anything else is read.
nlohmann::json picture_of(const Archive& archive);

/// How many samples the finest drawing of a run's signals takes together: those of the data and the bank, and those of
/// the other filters.
struct Detail {
  Index finest = 1, finest_others = 1;
};
/// Positions of the runs that the page draws and lists one by one: of each role the first hundred.
std::vector<std::size_t> drawn_runs(const Recording& recording);
/// Those runs' signals over time, and what each filter said of them.
nlohmann::json runs_section(const Archive& archive, PageArrays& arrays, const Detail& detail);
/// Bytes that these take in the page at most, but for outliers.
std::size_t most_signal_bytes(const Archive& archive, const Detail& detail);
/// The same in as fine a detail as at most so many bytes allow.
nlohmann::json affordable_runs_section(const Archive& archive, PageArrays& arrays, std::size_t bytes);

nlohmann::json windows_section(const Archive& archive, PageArrays& arrays);
nlohmann::json selection_section(const Archive& archive);
nlohmann::json bank_section(const Archive& archive);
nlohmann::json filter_section(const Archive& archive);

}  // namespace modebank::app::report
