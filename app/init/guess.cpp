#include "app/init/guess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/init/mounting.hpp"
#include "app/init/words.hpp"
#include "ident/base/characters.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_states = 2, most_inputs = 4;

struct Candidate {
  ChannelPlace place;
  const SurveyedTable* table;
  const SurveyedChannel* channel;
  NameScore score;
};

/// Whether a line of a configuration can hold the name, in quotes if need be.
bool may_be_named(const std::string& name) { return std::none_of(name.begin(), name.end(), is_control); }

std::vector<Candidate> candidates_of(const std::vector<SurveyedFile>& files) {
  std::vector<Candidate> all;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t) {
      const SurveyedTable& table = files[f].tables[t];
      // Names of CSV columns say nothing of where they come from, the file's name does: imu_03.csv.
      const std::string from = table.name.empty() ? files[f].path.stem().string() + " " : "";
      for (std::size_t c = 0; c < table.channels.size(); ++c) {
        const SurveyedChannel& channel = table.channels[c];
        if (!channel.moves() || channel.name == table.run || !may_be_named(channel.name)) continue;
        if (std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end()) continue;
        NameScore score = score_name(channel.name, from + table.type);
        if (!score.ignored) all.push_back({{f, t, c}, &table, &channel, score});
      }
    }
  return all;
}

bool same_table(const ChannelPlace& a, const ChannelPlace& b) { return a.file == b.file && a.table == b.table; }

/// Those of the most points, in the order of the file; within `slack` of the best and in its table.
std::vector<const Candidate*> best_of(const std::vector<Candidate>& all, int NameScore::*points, int slack,
                                      std::size_t most) {
  const Candidate* best = nullptr;
  for (const Candidate& c : all)
    if (c.score.*points > 0 && (best == nullptr || c.score.*points > best->score.*points)) best = &c;
  std::vector<const Candidate*> chosen;
  for (const Candidate& c : all)
    if (best != nullptr && same_table(c.place, best->place) && c.score.*points >= best->score.*points - slack &&
        c.score.*points > 0 && chosen.size() < most)
      chosen.push_back(&c);
  return chosen;
}

/// Of channels whose names say nothing: the last is the state, the others act on it, as usual in tables of u and y.
void guess_by_place(std::vector<Candidate>& all, Guess& guess) {
  guess.reasons.emplace_back(
      "names say nothing of the channels' parts: the last is taken for the state, the rest for inputs");
  guess.states = {all.back().place};
  for (std::size_t i = 0; i + 1 < all.size() && guess.inputs.size() < most_inputs; ++i)
    if (same_table(all[i].place, all.back().place)) guess.inputs.push_back(all[i].place);
}

void guess_states(std::vector<Candidate>& all, Guess& guess) {
  std::vector<Candidate> measured;
  for (const Candidate& c : all)
    if (c.score.state >= c.score.input) measured.push_back(c);
  for (const Candidate* state : best_of(measured.empty() ? all : measured, &NameScore::state, 0, most_states))
    guess.states.push_back(state->place);
}

void guess_inputs(const std::vector<Candidate>& all, Guess& guess) {
  std::vector<Candidate> acting;
  for (const Candidate& c : all) {
    const bool is_state = std::find(guess.states.begin(), guess.states.end(), c.place) != guess.states.end();
    // What an instrument measures beside the state does not act on it.
    const bool beside = same_table(c.place, guess.states.front()) && c.score.input < c.score.state;
    if (!is_state && !beside && c.score.input > 0) acting.push_back(c);
  }
  for (const Candidate* input : best_of(acting, &NameScore::input, 1, most_inputs))
    guess.inputs.push_back(input->place);
}

/// A gyro's rate about the axis that points up takes the place of that about z.
void turn_upright(const std::vector<SurveyedFile>& files, Guess& guess) {
  for (ChannelPlace& state : guess.states) {
    const SurveyedTable& table = files[state.file].tables[state.table];
    if (!names_angular_rate(table.channels[state.channel].name, Axis::z)) continue;
    guess.mounting = find_mounting(files, state);
    if (!guess.mounting) continue;
    for (std::size_t c = 0; c < table.channels.size(); ++c)
      if (table.channels[c].name == guess.mounting->up_rate) state.channel = c;
    return;
  }
}

}  // namespace

const SurveyedChannel& channel_at(const std::vector<SurveyedFile>& files, const ChannelPlace& place) {
  return files[place.file].tables[place.table].channels[place.channel];
}

Guess guess_roles(const std::vector<SurveyedFile>& files) {
  std::vector<Candidate> all = candidates_of(files);
  if (all.empty()) {
    std::string why;
    for (const SurveyedFile& file : files) {
      for (const std::string& note : file.notes) why += "; " + note;
      for (const SurveyedTable& table : file.tables)
        for (const SurveyedChannel& channel : table.channels)
          if (!channel.why_text.empty()) why += fmt::format("; column {}: {}", channel.name, channel.why_text);
    }
    throw ConfigurationError(fmt::format("{}: no channel moves: nothing can be a state{}",
                                         files.empty() ? "" : files.front().path.string(), why));
  }
  Guess guess;
  guess_states(all, guess);
  if (guess.states.empty()) {
    const bool known_inputs = std::any_of(all.begin(), all.end(), [](const Candidate& c) { return c.score.input > 0; });
    if (known_inputs)
      std::stable_sort(all.begin(), all.end(),
                       [](const Candidate& a, const Candidate& b) { return a.score.input > b.score.input; });
    guess_by_place(all, guess);
    return guess;
  }
  guess_inputs(all, guess);
  if (guess.inputs.empty())
    guess.reasons.emplace_back("no channel looks commanded: without inputs modes differ in their own motion alone");
  else if (score_name(channel_at(files, guess.inputs.front()).name).input < 5)
    guess.reasons.emplace_back(
        "no command is recorded: measured motion stands in for it, so the model says how one follows the other");
  turn_upright(files, guess);
  return guess;
}

}  // namespace modebank::app
