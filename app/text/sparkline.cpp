#include "app/text/sparkline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/text/judged_runs.hpp"
#include "app/text/stretch_means.hpp"

namespace modebank::app {
namespace {

constexpr int width_of_files = 100;  // width for files, which have no limit of their own
constexpr int shortest_run = 4;      // in characters

struct StripRun {
  const Trajectory* run;
  std::size_t position;  ///< index of the run in the recording
  Index characters = 0;
};

/// The bank's evaluation; null if there is none.
const FilterEvaluation* bank_evaluation(const Archive& archive) {
  const auto found = std::find_if(archive.evaluations.begin(), archive.evaluations.end(),
                                  [](const FilterEvaluation& filter) { return filter.filter == "bank"; });
  return found == archive.evaluations.end() || found->runs.empty() ? nullptr : &*found;
}

/// Runs with this role, in the order of the recording.
std::vector<StripRun> runs_of(const Archive& archive, Role role) {
  std::vector<StripRun> runs;
  for (std::size_t i = 0; i < archive.recording->runs.size(); ++i)
    if (const Trajectory& run = archive.recording->runs[i]; run.role == role) runs.push_back({&run, i});
  return runs;
}

/// Sets the number of characters of each run. All runs and their separators together have `width` characters. Drops
/// runs at the end until all others have at least shortest_run characters.
void share_width(std::vector<StripRun>& runs, Index width) {
  const auto most = static_cast<std::size_t>(std::max<Index>(1, (width + 1) / (shortest_run + 1)));
  if (runs.size() > most) runs.resize(most);
  Index samples = 0;
  for (const StripRun& run : runs) samples += run.run->samples();
  const auto count = static_cast<Index>(runs.size());
  const Index spare = std::max<Index>(0, width - (count - 1) - count * shortest_run);
  Index seen = 0;
  for (StripRun& run : runs) {
    const Index before = spare * seen / std::max<Index>(1, samples);
    seen += run.run->samples();
    run.characters = shortest_run + spare * seen / std::max<Index>(1, samples) - before;
  }
}

std::string names_line(const std::vector<StripRun>& runs) {
  std::string line;
  for (const StripRun& run : runs) {
    const std::string name = first_columns(run.run->run, static_cast<int>(run.characters));
    line += name + std::string(static_cast<std::size_t>(run.characters - columns_of(name)) + 1, ' ');
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

}  // namespace

std::string sparkline(const Eigen::VectorXd& values, bool utf8) {
  static constexpr std::array<const char*, 9> blocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  static constexpr std::string_view marks = " .:-=+*#%@";
  std::string line;
  for (const double value : values) {
    const double height = std::clamp(value, 0.0, 1.0);
    if (!std::isfinite(value))
      line += '?';
    else if (utf8)
      line += blocks[static_cast<std::size_t>(std::lround(height * (blocks.size() - 1)))];
    else
      line += marks[static_cast<std::size_t>(std::lround(height * static_cast<double>(marks.size() - 1)))];
  }
  return line;
}

std::string mode_strip_text(const Archive& archive, const Terminal& terminal) {
  if (!archive.bank || !archive.recording) return "";
  const FilterEvaluation* const bank = bank_evaluation(archive);
  if (bank == nullptr) return "";
  const Role role = judged_role(archive);
  std::vector<StripRun> runs = runs_of(archive, role);
  if (runs.empty()) return "";
  constexpr int label = 5, usage = 6;
  const int width = terminal.width > 0 ? terminal.width : width_of_files;
  const std::size_t all = runs.size();
  share_width(runs, std::max(shortest_run, width - label - usage));
  std::string text = fmt::format("mode probabilities on {} runs{}\n{:{}}{}\n", words_for(role),
                                 runs.size() < all ? fmt::format(" (the first {} of {})", runs.size(), all) : "", "run",
                                 label, names_line(runs));
  std::vector<std::string> lines(static_cast<std::size_t>(archive.bank->mode_count()));
  for (const StripRun& run : runs) {
    Eigen::MatrixXd means;
    bank->with_run(run.position, {"mode_probability"},
                   [&](const RunEvaluation& said) { means = stretch_means(said.mode_probability, run.characters); });
    const std::string space(static_cast<std::size_t>(run.characters - means.cols()), ' ');
    for (std::size_t k = 0; k < lines.size(); ++k)
      lines[k] += (lines[k].empty() ? ""
                   : terminal.utf8  ? "│"
                                    : "|") +
                  sparkline(means.row(static_cast<Index>(k)), terminal.utf8) + space;
  }
  for (std::size_t k = 0; k < lines.size(); ++k) {
    text += fmt::format("{:>4} {}", k, lines[k]);
    if (const DiagnosticsRow* row = diagnosis(archive, "bank", role, static_cast<Index>(k)))
      text += fmt::format(" {:>3.0f} %", 100 * row->usage);
    text += "\n";
  }
  return text;
}

}  // namespace modebank::app
