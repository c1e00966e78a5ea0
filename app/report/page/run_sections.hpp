#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/page_arrays.hpp"
#include "io/archive/archive.hpp"

/// Sections of a run's page. A section is null if the archive lacks its data.
namespace modebank::app::report {

/// Probability level of bands, regions and bounds in drawings.
inline constexpr double drawn_level = 0.95;

nlohmann::json origin_section(const Archive& archive);
/// Content of the first screen, with the same words and numbers (screen_facts.hpp).
nlohmann::json verdict_section(const Archive& archive);

/// Number of samples per bucket in the finest drawing of a run's signals. One number is for data and bank, the other
/// for all other filters.
struct Detail {
  Index finest = 1, finest_others = 1;
};
/// Indices of the runs that the page draws and lists: the first hundred of each role.
std::vector<std::size_t> drawn_runs(const Recording& recording);
/// Signals of these runs over time, with each filter's evaluation.
nlohmann::json runs_section(const Archive& archive, PageArrays& arrays, const Detail& detail);
/// Largest possible size of the signals in the page, without outliers [bytes].
std::size_t most_signal_bytes(const Archive& archive, const Detail& detail);
/// The signals of these runs in the finest detail that fits into `most` bytes.
nlohmann::json affordable_runs_section(const Archive& archive, PageArrays& arrays, std::size_t bytes);

/// The most probable mode of a filter over each window, by the mean of mode_probability over the window's transitions.
/// -1 if it is unknown. `length`: number of transitions per window.
Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const FilterEvaluation& evaluation);
nlohmann::json windows_section(const Archive& archive, PageArrays& arrays);
nlohmann::json selection_section(const Archive& archive);
nlohmann::json bank_section(const Archive& archive);
nlohmann::json filter_section(const Archive& archive);

}  // namespace modebank::app::report
