#include "io/simulation_writer.hpp"

#include <csv.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ident/error.hpp"
#include "io/join_streams.hpp"
#include "io/replace_file.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A name as one CSV field, quoted only when it has to be.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string field(2 * name.size() + 2, '\0');
  field.resize(csv_write(field.data(), field.size(), name.data(), name.size()));
  return field;
}

std::string header(const std::vector<std::string>& names) {
  std::string line;
  for (std::size_t i = 0; i < names.size(); ++i) line += (i == 0 ? "" : ",") + quoted(names[i]);
  return line + "\n";
}

void check_header(const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty() || std::count(names.begin(), names.end(), names[i]) > 1)
      throw ConfigurationError(
          fmt::format("simulated file: column {} \"{}\" is empty or there twice", i + 1, names[i]));
}

std::vector<std::string> inputs_header(const SimulationLayout& layout) {
  std::vector<std::string> names{"time"};
  names.insert(names.end(), layout.inputs.begin(), layout.inputs.end());
  for (const std::string& state : layout.states) names.push_back("true_" + state);
  names.emplace_back("mode");
  return names;
}

std::vector<std::string> states_header(const SimulationLayout& layout) {
  std::vector<std::string> names{"time"};
  names.insert(names.end(), layout.states.begin(), layout.states.end());
  return names;
}

/// Numbers in their shortest form that reads back exactly.
template <class Column>
void append_values(std::string& text, const Column& values) {
  for (const double value : values) fmt::format_to(std::back_inserter(text), ",{}", value);
}

std::string inputs_file(const SimulatedRun& run, const SimulationLayout& layout) {
  std::string text = header(inputs_header(layout));
  const Trajectory& measured = run.measured;
  for (Index k = 0; k < measured.samples(); ++k) {
    fmt::format_to(std::back_inserter(text), "{}", measured.time_s(k));
    append_values(text, measured.input.col(k));
    append_values(text, measured.truth.col(k));
    fmt::format_to(std::back_inserter(text), ",{}\n", run.mode(k));
  }
  return text;
}

/// Covers all of the run, and one period more so that no rounding of times cuts its last sample off.
VectorXd states_times(const VectorXd& time_s, double rate_hz) {
  const double duration_s = time_s(time_s.size() - 1) - time_s(0);
  VectorXd result(static_cast<Index>(std::ceil(duration_s * rate_hz)) + 2);
  for (Index k = 0; k < result.size(); ++k) result(k) = time_s(0) + static_cast<double>(k) / rate_hz;
  return result;
}

std::string states_file(const SimulatedRun& run, const SimulationLayout& layout) {
  std::string text = header(states_header(layout));
  const Stream measured{run.measured.time_s, run.measured.state};
  const VectorXd time_s = states_times(measured.time_s, layout.state_rate_hz);
  const MatrixXd state = interpolate(measured, time_s);
  for (Index k = 0; k < time_s.size(); ++k) {
    fmt::format_to(std::back_inserter(text), "{}", time_s(k));
    append_values(text, state.col(k));
    text += "\n";
  }
  return text;
}

void check_layout(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout) {
  constexpr double highest_rate_hz = 1e6;
  if (!(layout.state_rate_hz > 0.0 && layout.state_rate_hz <= highest_rate_hz))
    throw ConfigurationError(fmt::format("simulated states' rate {} Hz: must be above 0 and at most {}",
                                         layout.state_rate_hz, highest_rate_hz));
  check_header(inputs_header(layout));
  check_header(states_header(layout));
  for (const SimulatedRun& run : runs) {
    const Trajectory& measured = run.measured;
    if (measured.state.rows() != static_cast<Index>(layout.states.size()) ||
        measured.input.rows() != static_cast<Index>(layout.inputs.size()))
      throw ConfigurationError(fmt::format("{} state and {} input names for {} simulated states and {} inputs",
                                           layout.states.size(), layout.inputs.size(), measured.state.rows(),
                                           measured.input.rows()));
    if (measured.samples() < 1) throw ConfigurationError("a simulated run has no sample");
    if (measured.truth.rows() != measured.state.rows() || measured.truth.cols() != measured.samples() ||
        run.mode.size() != measured.samples())
      throw ConfigurationError("a simulated run lacks truth or modes");
  }
}

void make_folder(const std::filesystem::path& folder, const std::filesystem::path& first_file) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);  // no error when it exists
  if (error) throw ConfigurationError(fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
  if (const std::string obstacle = write_obstacle(first_file); !obstacle.empty())
    throw ConfigurationError(fmt::format("cannot write {}: {}", first_file.string(), obstacle));
}

}  // namespace

void write_simulation(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout) {
  check_layout(runs, layout);
  const std::size_t digits = std::max<std::size_t>(2, fmt::formatted_size("{}", runs.empty() ? 0 : runs.size() - 1));
  const auto path = [&](const char* kind, std::size_t run) {
    return layout.folder / fmt::format("{}_{:0{}}.csv", kind, run, digits);
  };
  make_folder(layout.folder, path("pro", 0));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    replace_file(path("pro", i), {inputs_file(runs[i], layout)});
    replace_file(path("imu", i), {states_file(runs[i], layout)});
  }
}

}  // namespace modebank
