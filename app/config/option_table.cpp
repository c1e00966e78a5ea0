#include "app/config/option_table.hpp"

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "app/config/options/sections.hpp"

namespace modebank::app {

DataOptions data_options_of(const Config& c) {
  DataOptions data = c.data;
  if (data.split.kind == SplitKind::none) return data;
  const SearchedLags searched = searched_lags_of(c);
  const Index states = searched.state ? usual_lags : c.window.state_lags;
  const Index inputs = searched.input ? usual_lags : c.window.input_lags;
  data.split.gap_samples = c.window.length + std::max(states, inputs + c.window.input_delay.latest());
  return data;
}

FitOptions window_options_of(const Config& c) {
  FitOptions window = c.window;
  if (c.structure.automatic_model && has_lags(window)) window.model = "varx";
  return window;
}

SearchedLags searched_lags_of(const Config& c) {
  const bool by_model = c.structure.automatic_model;
  const auto searched = [&](LagChoice choice) { return is_automatic(choice, by_model); };
  return {searched(c.structure.state), searched(c.structure.input), searched(c.structure.delay)};
}

AutomaticWindows automatic_windows_of(const Config& c) {
  const bool by_model = c.structure.automatic_model;
  return {is_automatic(c.structure.length, by_model), is_automatic(c.structure.step, by_model),
          c.structure.automatic_intercept};
}

ChainOptions chain_options(const Config& c) {
  LearningOptions learning{
      window_options_of(c),    c.mixture, c.bank, c.filter, c.scoring, c.job.seed, searched_lags_of(c),
      automatic_windows_of(c), c.terms};
  learning.bank.screen = learning.bank.theta != ThetaSource::mean;
  learning.bank.em.restarts = refinement_restarts(c.mixture.selection.em.restarts);
  return {learning, data_options_of(c), c.mode_names};
}

std::vector<std::string> choices_in(const std::string& text) {
  std::vector<std::string> words;
  boost::split(words, text, [](char c) { return c == '|'; });
  for (std::string& word : words) boost::trim(word);
  const bool all_words = std::all_of(words.begin(), words.end(), [](const std::string& word) {
    return !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
  });
  return all_words && words.size() > 1 ? words : std::vector<std::string>{};
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

const Option* find_option(const std::string& key) { return find_option(option_table(), key); }

const Option* find_option(const std::vector<Option>& table, const std::string& key) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const Option& option) { return option.key == key; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace modebank::app
