#include "app/config/option_table.hpp"

#include <algorithm>

#include "app/config/options/sections.hpp"

namespace modebank::app {

DataOptions data_options_of(const Config& c) {
  DataOptions data = c.data;
  if (data.split.kind == SplitKind::none) return data;
  const Index automatic = most_automatic_lags;
  const Index states = c.automatic_lags.state ? automatic : c.window.state_lags;
  const Index inputs = c.automatic_lags.input ? automatic : c.window.input_lags;
  data.split.gap_samples = c.window.length + std::max(states, inputs + c.window.input_delay);
  return data;
}

ChainOptions chain_options(const Config& c) {
  return {data_options_of(c), c.window,  c.mixture,  c.mixture_start,  c.bank,
          c.filter,           c.scoring, c.job.seed, c.automatic_lags, c.mode_names};
}

const std::vector<Option>& option_table() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all;
    for (auto section : {data_options, window_options, mixture_options, bank_options, filter_options, archive_options,
                         study_options, track_options, report_options, simulate_options})
      for (Option& entry : section()) all.push_back(std::move(entry));
    return all;
  }();
  return table;
}

const Option* find_option(const std::string& key) {
  const std::vector<Option>& table = option_table();
  const auto found = std::find_if(table.begin(), table.end(), [&](const Option& option) { return option.key == key; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace modebank::app
