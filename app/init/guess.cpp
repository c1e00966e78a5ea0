#include "app/init/guess.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/init/mounting.hpp"
#include "app/init/unreachable_commands.hpp"
#include "app/init/words.hpp"
#include "ident/base/printable.hpp"
#include "io/import/expression.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_states = 2, most_inputs = 4;
constexpr int least_of_command = 5;  // points of a name that tells of a command; measured motions have less

struct Candidate {
  ChannelPlace place;
  const SurveyedTable* table;
  const SurveyedChannel* channel;
  NameScore score;  ///< score from all hints
  NameScore named;  ///< score from the name alone

  bool is_held() const { return channel->check.repeated > most_repeated; }
  bool is_set_point() const { return !words_of_measured(channel->name).empty(); }
  /// Whether the hints name what acts, and not a motion or a supply that is only measured.
  bool is_actuator() const {
    return !is_set_point() && score.input >= least_of_command && channel->name.find("batt") == std::string::npos;
  }
};

bool same_table(const ChannelPlace& a, const ChannelPlace& b) { return a.file == b.file && a.table == b.table; }

bool is_in(const std::vector<ChannelPlace>& places, const ChannelPlace& place) {
  return std::find(places.begin(), places.end(), place) != places.end();
}

/// Adds the hints that do not come from names. A channel whose value is held while other channels of its table move is
/// probably a command. Units such as rad/s indicate measurements, and units such as V indicate inputs.
void add_hints(std::vector<Candidate>& all) {
  constexpr int held = 3, unit = 2;
  constexpr double moving =
      0.2;  // an instrument that measures in nearly every row repeats at most this share of its values
  for (Candidate& c : all) {
    const bool others_move = std::any_of(all.begin(), all.end(), [&](const Candidate& other) {
      return same_table(other.place, c.place) && other.channel->check.repeated < moving;
    });
    if (c.is_held() && others_move) {
      c.score.input += held;
      c.score.state = std::max(0, c.score.state - held);
    }
    c.score.state += unit_of_measured(c.channel->unit) ? unit : 0;
    c.score.input += unit_of_acting(c.channel->unit) ? unit : 0;
  }
}

/// Whether all values are 0 but the last one, which is 1: it marks the end of a run.
bool marks_the_end(const SurveyedChannel& channel) {
  return channel.check.levels == 2 && channel.values.sum() == 1.0 && channel.values.tail(1)(0) == 1.0;
}

/// What a set point names is the state, if it is measured: level_cm beside level_setpoint_cm.
void prefer_what_set_points_name(std::vector<Candidate>& all) {
  constexpr int named = 8;
  for (Candidate& c : all)
    if (std::any_of(all.begin(), all.end(), [&](const Candidate& other) {
          return !c.is_set_point() && words_of_measured(other.channel->name) == words_of_name(c.channel->name);
        }))
      c.score.state += named;
}

std::vector<Candidate> candidates_of(const std::vector<SurveyedFile>& files) {
  std::vector<Candidate> all;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t) {
      const SurveyedTable& table = files[f].tables[t];
      // CSV columns do not contain the name of their instrument, but the file name does: imu_03.csv.
      const std::string from = table.name.empty() ? files[f].path.stem().string() + " " : "";
      for (std::size_t c = 0; c < table.channels.size(); ++c) {
        const SurveyedChannel& channel = table.channels[c];
        if (!channel.moves() || channel.counts || channel.name == table.run || !can_be_stated(channel.name)) continue;
        if (std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end()) continue;
        if (marks_the_end(channel)) continue;
        NameScore score = score_name(channel.name, from + table.type);
        if (!score.ignored) all.push_back({{f, t, c}, &table, &channel, score, score});
      }
    }
  add_hints(all);
  prefer_what_set_points_name(all);
  // A channel that rests in every run cannot explain what happens within one.
  if (std::count_if(all.begin(), all.end(), [](const Candidate& c) { return !c.channel->rests; }) > 1)
    std::erase_if(all, [](const Candidate& c) { return c.channel->rests; });
  return all;
}

/// The channels in the table of the best candidate whose points are at most `slack` below the best. Points come from
/// all hints or from the name alone. The order is that of the file.
std::vector<const Candidate*> best_of(const std::vector<Candidate>& all, int NameScore::*points, int slack,
                                      std::size_t most) {
  const Candidate* best = nullptr;
  const auto is_better = [&](const Candidate& c) {  // of equal ones in a table, the one that more rows have
    const bool alike = c.score.*points == best->score.*points && same_table(c.place, best->place);
    return c.score.*points > best->score.*points || (alike && c.channel->check.missing < best->channel->check.missing);
  };
  for (const Candidate& c : all)
    if (c.score.*points > 0 && (best == nullptr || is_better(c))) best = &c;
  const auto share_rows = [](const SurveyedChannel& a, const SurveyedChannel& b) {
    return (a.values.array().isFinite() && b.values.array().isFinite()).any();
  };
  std::vector<const Candidate*> chosen;
  for (const Candidate& c : all)
    if (best != nullptr && same_table(c.place, best->place) && c.score.*points > 0 && chosen.size() < most &&
        share_rows(*c.channel, *best->channel) &&
        (c.score.*points >= best->score.*points - slack ||
         (slack > 0 && c.named.*points >= best->named.*points - slack)))
      chosen.push_back(&c);
  return chosen;
}

/// Whether a channel is one axis of a rate or acceleration, or of any vector that an instrument measures.
bool is_motion_of_axes(const std::string& name) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (names_angular_rate(name, axis) || names_acceleration(name, axis)) return true;
  return false;
}
bool is_of_axes(const std::string& name) {
  return is_motion_of_axes(name) || names_position(name, Axis::x) || names_position(name, Axis::y) ||
         names_position(name, Axis::z);
}

/// Guesses the state if no hint indicates one. In tables of u and y, y is usually last. So this takes the channel that
/// is least likely an input, and the last one of equally likely channels.
void guess_state_by_place(const std::vector<Candidate>& all, Guess& guess) {
  const auto least = std::min_element(
      all.rbegin(), all.rend(), [](const Candidate& a, const Candidate& b) { return a.score.input < b.score.input; });
  guess.states = {least->place};
}

/// Guesses the inputs if no name indicates one. Takes channels in the state's table that were not measured together
/// with the state. They must be held, or the table must have few channels. Without any, takes the held channels of
/// another file.
void guess_inputs_by_place(const std::vector<Candidate>& all, bool by_place, Guess& guess) {
  constexpr std::ptrdiff_t few = 4;
  const auto beside = std::count_if(all.begin(), all.end(),
                                    [&](const Candidate& c) { return same_table(c.place, guess.states.front()); });
  std::vector<std::string> names;
  const std::size_t named = guess.inputs.size();
  for (const bool here : {true, false}) {
    if (!here && named + names.size() > 0) break;
    for (const Candidate& c : all) {
      if (is_in(guess.states, c.place) || is_in(guess.inputs, c.place) || guess.inputs.size() == most_inputs) continue;
      if (here != same_table(c.place, guess.states.front()) || c.score.state > 0 || is_of_axes(c.channel->name))
        continue;
      const bool few_here = here && (by_place || beside <= few);
      if (!few_here && (!c.is_held() || (!here && c.place.file == guess.states.front().file))) continue;
      guess.inputs.push_back(c.place);
      names.push_back(c.channel->name);
    }
  }
  if (!names.empty())
    guess.reasons.push_back({fmt::format("no name indicates {}; {} {} taken, because nothing else may be one",
                                         named > 0 ? "an actuator beside the set point" : "an input",
                                         fmt::join(names, ", "), names.size() == 1 ? "is" : "are"),
                             "input"});
}

void guess_states(std::vector<Candidate>& all, Guess& guess) {
  std::vector<Candidate> measured;
  const auto commands = [](const Candidate& c) { return c.score.input >= 10; };
  const bool commanded = std::any_of(all.begin(), all.end(), commands);  // then wheels are measured and no inputs
  for (const Candidate& c : all)
    if (c.score.state >= c.score.input || (commanded && c.score.state > 0)) measured.push_back(c);
  for (const Candidate* state : best_of(measured.empty() ? all : measured, &NameScore::state, 0, most_states))
    guess.states.push_back(state->place);
}

void guess_inputs(const std::vector<SurveyedFile>& files, const std::vector<Candidate>& all, bool by_place,
                  Guess& guess) {
  std::vector<Candidate> acting;
  for (const Candidate& c : all) {
    // A channel that the state's instrument measures is not an input.
    const bool beside = same_table(c.place, guess.states.front()) && c.score.input < c.score.state;
    if (!is_in(guess.states, c.place) && !beside && c.score.input > 0) acting.push_back(c);
  }
  // A set point acts through a controller, so what the controller moves is the input.
  const bool loop = std::any_of(all.begin(), all.end(), [&](const Candidate& c) {
    return words_of_measured(c.channel->name) == words_of_name(channel_at(files, guess.states.front()).name);
  });
  if (loop && std::any_of(acting.begin(), acting.end(), [](const Candidate& c) { return c.is_actuator(); }))
    std::erase_if(acting, [](const Candidate& c) { return c.is_set_point(); });
  const std::vector<const Candidate*> best = best_of(acting, &NameScore::input, 1, most_inputs);
  for (const Candidate* input : best) guess.inputs.push_back(input->place);
  if (std::all_of(best.begin(), best.end(), [](const Candidate* c) { return c->is_set_point(); }))
    guess_inputs_by_place(all, by_place, guess);
}

/// An axis of a rate or acceleration that hardly moves is no state: a sister that moves takes its place.
void leave_resting_axis(const std::vector<SurveyedFile>& files, ChannelPlace& state, Guess& guess) {
  constexpr double hardly = 0.02;
  const std::vector<SurveyedChannel>& channels = files[state.file].tables[state.table].channels;
  const auto stem = [](const std::string& name) { return name.substr(0, name.size() - 1); };
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (const SurveyedChannel& rests = channels[state.channel];
        is_motion_of_axes(rests.name) && is_motion_of_axes(channels[c].name) &&
        stem(channels[c].name) == stem(rests.name) && rests.check.sd < hardly * channels[c].check.sd) {
      guess.reasons.push_back(
          {fmt::format("{} hardly moves beside {}, which is taken", rests.name, channels[c].name), "state"});
      state.channel = c;
    }
}

/// If the gyro lies on its side, replaces the rate about z by the rate about the axis that points up.
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

/// Whether the name is that of a measured speed or rate, and not of a command.
bool is_measured_motion(const std::vector<SurveyedFile>& files, const ChannelPlace& place) {
  const int points = score_name(channel_at(files, place).name).input;
  return points > 0 && points < least_of_command;
}

/// Reason why a channel that a user may expect is not used; empty without a reason.
std::string why_left(const SurveyedTable& table, const SurveyedChannel& channel) {
  if (!channel.why_text.empty()) return fmt::format("; column {}: {}", channel.name, channel.why_text);
  if (!channel.moves()) return "";
  if (!can_be_stated(channel.name))
    return fmt::format("; column '{}': a configuration cannot contain an empty name or a control character; rename it",
                       printable_name(channel.name));
  const bool is_time = std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end();
  if (is_time || !score_name(channel.name).ignored) return "";
  return fmt::format(
      "; column {}: the name indicates a time, counter, pose, place or label; rename it if it is a signal",
      channel.name);
}

std::string why_nothing_moves(const std::vector<SurveyedFile>& files) {
  std::string why;
  for (const SurveyedFile& file : files) {
    for (const std::string& note : file.notes) why += "; " + note;
    for (const SurveyedTable& table : file.tables)
      for (const SurveyedChannel& channel : table.channels) why += why_left(table, channel);
  }
  return why;
}

}  // namespace

const SurveyedChannel& channel_at(const std::vector<SurveyedFile>& files, const ChannelPlace& place) {
  return files[place.file].tables[place.table].channels[place.channel];
}

Guess guess_roles(const std::vector<SurveyedFile>& files) {
  std::vector<Candidate> all = candidates_of(files);
  if (all.empty()) {
    throw DataError(fmt::format("{}: no channel can be the state, because no column has numbers that change{}",
                                files.empty() ? "" : files.front().path.string(), why_nothing_moves(files)));
  }
  Guess guess;
  guess_states(all, guess);
  const bool by_place = guess.states.empty();
  if (by_place) {
    guess.reasons.push_back(
        {"no name indicates the state; the last channel without a hint of an input is taken", "state"});
    guess_state_by_place(all, guess);
  }
  guess_inputs(files, all, by_place, guess);
  if (guess.inputs.empty())
    guess.reasons.push_back(
        {"no channel looks like a command; without inputs modes differ only in the motion of the state itself",
         "input"});
  else if (!by_place && is_measured_motion(files, guess.inputs.front()))
    guess.reasons.push_back(
        {"no command is recorded: measured motion is used instead, so the model describes how one follows the other",
         "input"});
  replace_unreachable_commands(files, guess);
  turn_upright(files, guess);
  if (!guess.mounting)
    for (ChannelPlace& state : guess.states) leave_resting_axis(files, state, guess);
  return guess;
}

std::vector<ChannelLeft> channels_left(const std::vector<SurveyedFile>& files, const Guess& guess) {
  std::vector<ChannelLeft> left;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t)
      for (std::size_t c = 0; c < files[f].tables[t].channels.size(); ++c) {
        const ChannelPlace place{f, t, c};
        const SurveyedTable& table = files[f].tables[t];
        const SurveyedChannel& channel = channel_at(files, place);
        const bool is_time = std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end();
        const bool is_run = !channel.name.empty() && channel.name == table.run;
        if (is_time || is_run || is_in(guess.states, place) || is_in(guess.inputs, place)) continue;
        const NameScore score = score_name(channel.name);
        if (!channel.is_number() && !channel.why_text.empty() && !score.ignored)
          left.push_back({channel.name, fmt::format("text ({})", channel.why_text)});
        if (!channel.moves()) continue;
        const bool beside = same_table(place, guess.states.front());
        const bool with_inputs = !guess.inputs.empty() && same_table(place, guess.inputs.front());
        if (channel.name.empty()) {
          left.push_back({fmt::format("column {}", c + 1), "without a name"});
          continue;
        }
        const bool is_signal = !score.ignored && can_be_stated(channel.name) && !channel.counts && !channel.rests;
        const int points = !is_signal ? 0 : is_of_axes(channel.name) ? 1 : 2 + score.input;
        const SurveyedChannel& state = channel_at(files, guess.states.front());
        const bool repeats = beside && channel.is_number() && channel.values == state.values;
        left.push_back({channel.name,
                        score.ignored                  ? "the name indicates a time, counter, pose, place or label"
                        : !can_be_stated(channel.name) ? "the name contains a line end or another control character"
                        : channel.counts               ? "counts up evenly, as times and counters do"
                        : channel.rests                ? "constant in every run"
                        : repeats                      ? fmt::format("repeats {} in every row", state.name)
                        : score.input > score.state && with_inputs
                            ? fmt::format("other channels are likelier inputs; at most {} are taken", most_inputs)
                        : beside || with_inputs ? "measured beside the state, or without a hint of its role"
                                                : "in another table than the state and the inputs",
                        points});
      }
  return left;
}

}  // namespace modebank::app
