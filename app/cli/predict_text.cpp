#include "app/cli/predict_text.hpp"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "io/files/csv_field.hpp"

namespace modebank::app {

using nlohmann::json;

Index predicted_samples(const std::vector<FreeRun>& predicted) {
  Index samples = 0;
  for (const FreeRun& run : predicted) samples += (run.mode.array() >= 0).count();
  return samples;
}

std::string predicted_csv(const Recording& recording, const std::vector<FreeRun>& predicted) {
  fmt::memory_buffer out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "run,time");
  for (const Channel& s : recording.states)
    for (const char* what : {"_predicted", "_sd", "_lower", "_upper"})
      fmt::format_to(to, ",{}", csv_field(s.name + what));
  fmt::format_to(to, ",mode\n");
  for (std::size_t r = 0; r < predicted.size(); ++r) {
    const FreeRun& run = predicted[r];
    for (Index k = 0; k < run.mode.size(); ++k) {
      if (run.mode(k) < 0) continue;
      fmt::format_to(to, "{},{}", csv_field(recording.runs[r].run), recording.runs[r].time_s(k));
      for (Index i = 0; i < run.mean.rows(); ++i)
        fmt::format_to(to, ",{},{},{},{}", run.mean(i, k), run.deviation(i, k), run.lower(i, k), run.upper(i, k));
      fmt::format_to(to, ",{}\n", run.mode(k));
    }
  }
  return fmt::to_string(out);
}

json predicted_json(const Recording& recording, const std::vector<FreeRun>& predicted) {
  json runs = json::array();
  for (std::size_t r = 0; r < predicted.size(); ++r) {
    const FreeRun& run = predicted[r];
    json object{{"run", recording.runs[r].run}, {"time_s", json::array()}, {"mode", json::array()}};
    for (Index k = 0; k < run.mode.size(); ++k) {
      if (run.mode(k) < 0) continue;
      object["time_s"].push_back(recording.runs[r].time_s(k));
      object["mode"].push_back(run.mode(k));
      for (Index i = 0; i < run.mean.rows(); ++i) {
        json& state = object["states"][recording.states[static_cast<std::size_t>(i)].name];
        state["predicted"].push_back(run.mean(i, k));
        state["sd"].push_back(run.deviation(i, k));
        state["lower"].push_back(run.lower(i, k));
        state["upper"].push_back(run.upper(i, k));
      }
    }
    runs.push_back(std::move(object));
  }
  return runs;
}

}  // namespace modebank::app
