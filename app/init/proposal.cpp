#include "app/init/proposal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "app/init/proposed_times.hpp"
#include "app/init/words.hpp"
#include "ident/base/characters.hpp"
#include "ident/base/natural_order.hpp"
#include "ident/base/printable.hpp"
#include "ident/check/stream_check.hpp"
#include "io/import/expression.hpp"
#include "io/import/split.hpp"
#include "modebank/base/error.hpp"
#include "modebank/ident/options.hpp"

namespace modebank::app {
namespace {

using Path = std::filesystem::path;

/// Whether a name contains characters that have another meaning in a list of names or in a configuration line.
bool needs_quotes(const std::string& name) { return name.find_first_of(",#'\"") != std::string::npos; }

/// The last two parts of a channel's name, as an identifier. Spreadsheets write the unit after a comma: Flow, l/h.
std::string short_name(const std::string& name) {
  if (const std::size_t comma = name.find(','); comma != std::string::npos && comma > 0) {
    std::string result = letters_and_digits(name.substr(0, comma));
    std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!result.empty() && !is_digit(result.front())) return result;
  }
  std::size_t from = name.find_last_of("./");
  if (from != std::string::npos && from > 0) from = name.find_last_of("./", from - 1);
  const std::string result = letters_and_digits(name.substr(from == std::string::npos ? 0 : from + 1));
  return result.empty() || is_digit(result.front()) ? "channel_" + result : result;
}

/// Builds the proposed configuration from the survey.
class Proposer {
 public:
  Proposer(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess)
      : sets_(sets), surveyed_(surveyed), guess_(guess) {}

  Proposal propose(const std::string& config_folder) {
    files(config_folder);
    mounting();
    channels();
    propose_times(table(state()), table(input()), proposal_);
    sampling();
    runs();
    not_taken();
    return std::move(proposal_);
  }

 private:
  const std::vector<FileSet>& sets_;
  const std::vector<SurveyedFile>& surveyed_;
  const Guess& guess_;
  Proposal proposal_;
  std::string turned_;                              // name of the derived yaw rate, if the gyro lies on its side
  std::map<std::string, std::string> short_names_;  // short names of the channels that have long names

  const ChannelPlace& state() const { return guess_.states.front(); }
  const ChannelPlace& input() const { return guess_.inputs.empty() ? state() : guess_.inputs.front(); }
  const SurveyedTable& table(const ChannelPlace& place) const { return surveyed_[place.file].tables[place.table]; }
  const SurveyedChannel& channel(const ChannelPlace& place) const { return table(place).channels[place.channel]; }
  bool one_table() const { return state().file == input().file && state().table == input().table; }

  void add(std::string key, std::string value, std::string why = {}) {
    proposal_.add(std::move(key), std::move(value), std::move(why));
  }
  void doubt(const std::string& text) { proposal_.doubt(text); }

  void not_taken() {
    std::vector<std::string> names;
    for (const ChannelLeft& channel : proposal_.left = channels_left(surveyed_, guess_))
      if (channel.points > 0) names.push_back(channel.name);
    if (!names.empty()) doubt(fmt::format("not taken although moving: {} (data.input takes others)", first_of(names)));
  }

  /// Names inputs that often stand at an end of their range, where a limiter acts, and states that wrap: they jump by
  /// nearly all of 360, 2 pi or a power of two.
  void limits() {
    for (const ChannelPlace& place : guess_.inputs) {
      const SurveyedChannel& input = channel(place);
      const SaturationLimits limits = saturation_limits({input.values});
      for (const auto& [end, from] :
           {std::pair(input.check.least, limits.low), std::pair(input.check.largest, limits.high)})
        if (const double share = ((input.values.array() - end).abs() <= std::abs(from - end)).cast<double>().mean();
            share > 0.05 && !limits.soft)
          doubt(fmt::format("{} stands at its limit, {:g}, in {:.0f} % of the samples (data.input)", input.name, end,
                            100.0 * share));
    }
    for (const ChannelPlace& place : guess_.states)
      for (const double period : {360.0, 2.0 * std::numbers::pi, 256.0, 1024.0, 4096.0, 65536.0, 0x1p32}) {
        const SurveyedChannel& state = channel(place);
        const Eigen::Index steps = state.values.size() - 1;
        const Eigen::ArrayXd turns = (state.values.tail(steps) - state.values.head(steps)).array().abs() / period;
        const double range = (state.check.largest - state.check.least) / period;
        if (range > 0.9 && range < 1.001 && (turns > 0.8).any() && !(turns > 0.2 && turns < 0.8).any())
          doubt(
              fmt::format("{0} jumps by {1:.9g}: state data.derive = turned = unwrap({2} * 2 * pi / {1:.9g}) and "
                          "data.state = turned",
                          state.name, period, quoted_channel_name(state.name)));
      }
  }

  std::string runs_text(const FileSet& set, bool listed) const {
    if (set.files.size() == 1) return "one file";
    if (listed) return fmt::format("{} runs, named by their files", set.files.size());
    const std::vector<std::size_t> order = natural_order(set.runs);
    return fmt::format("{} runs; * names them: {} to {}", set.runs.size(), set.runs[order.front()],
                       set.runs[order.back()]);
  }

  /// The folder that contains all files of both sets.
  static Path common_folder(const FileSet& a, const FileSet& b) {
    Path folder = a.files.front().parent_path();
    const auto holds = [&](const Path& file) { return (file.string()).starts_with((folder / "").string()); };
    while (folder != folder.root_path() &&
           !(std::all_of(a.files.begin(), a.files.end(), holds) && std::all_of(b.files.begin(), b.files.end(), holds)))
      folder = folder.parent_path();
    return folder;
  }

  void files(const std::string& config_folder) {
    const FileSet &inputs = sets_[input().file], &states = sets_[state().file];
    const Path folder = common_folder(inputs, states);
    const Path relative = folder.lexically_relative(config_folder);
    const bool below = !relative.empty() && *relative.begin() != "..";
    add("root", below ? relative.string() : folder.string(), "folder of the data");
    const bool listed = inputs.pattern.empty() || states.pattern.empty();
    const auto within = [&](const FileSet& set) {
      if (!listed) return Path(set.pattern).lexically_relative(folder).string();
      std::vector<std::string> names;
      for (const Path& file : set.files) names.push_back(file.lexically_relative(folder).string());
      return fmt::format("{}", fmt::join(names, ", "));
    };
    add("inputs", within(inputs), runs_text(inputs, listed));
    skipped_lines();
    const bool two = input().file != state().file;
    if (two) add("states", within(states), "measured states of the same runs");
    for (const FileSet* set : {&inputs, &states})
      for (const Path& file : set->files)
        if (listed && file.string().find(',') != std::string::npos)
          doubt(fmt::format("{} is left out: names in a list cannot contain commas", typed_path(file)));
    for (const FileSet& set : sets_)
      if (&set != &inputs && &set != &states)
        doubt(fmt::format("{} file{} with other columns left out: {}{}", set.files.size(),
                          set.files.size() == 1 ? " is" : "s are", set.files.front().filename().string(),
                          set.files.size() > 1 ? fmt::format(" and {} more", set.files.size() - 1) : ""));
    if (two && (inputs.files.size() != states.files.size() || (!listed && inputs.runs != states.runs)) &&
        inputs.files.size() + states.files.size() > 2)
      doubt(fmt::format("{} and {} have different runs; every inputs file needs a states file", within(inputs),
                        within(states)));
  }

  void skipped_lines() {
    const SurveyedFile &inputs = surveyed_[input().file], &states = surveyed_[state().file];
    if (inputs.skipped_alike && states.skipped_alike && inputs.skipped == states.skipped) {
      if (inputs.skipped > 0) add("skip_rows", fmt::format("{}", inputs.skipped), "lines of a title above the table");
    } else {
      add("skip_rows", "auto", "title lines above the table; their number differs between files");
    }
  }

  void mounting() {
    if (!guess_.mounting) return;
    const Mounting& m = *guess_.mounting;
    const char letter = "xyz"[static_cast<int>(m.up)];
    const std::string sign = m.reversed ? "-" : "";
    std::string text = fmt::format(
        "gravity acts along {}{} of this instrument ({:.2f} m/s^2), so it is mounted on its side, and the yaw rate is "
        "{}{}, not {}",
        m.reversed ? "-" : "+", letter, std::abs(m.gravity), sign, m.up_rate, m.z_rate);
    if (m.z_correlation)
      text += fmt::format(" (correlation with {}: {:.2f} and {:.2f})", m.other, *m.up_correlation, *m.z_correlation);
    doubt(text + " (data.state)");
    std::vector<std::string> parts;
    for (const SurveyedChannel& c : table(state()).channels)
      for (const Axis axis : {Axis::x, Axis::y, Axis::z})
        if (names_angular_rate(c.name, axis) && parts.size() < 3) parts.push_back(quoted_channel_name(c.name));
    const std::string half = m.reversed ? "-pi/2" : "pi/2", other_half = m.reversed ? "pi/2" : "-pi/2";
    const std::string angles = m.up == Axis::y   ? half + ", 0, 0"
                               : m.up == Axis::x ? "0, " + other_half + ", 0"
                                                 : std::string("pi, 0, 0");
    if (parts.size() < 3) return;
    const std::string rotation = fmt::format("yaw_rate [rad/s] = rotate_z({}, {})", angles, fmt::join(parts, ", "));
    if (m.reversed) {
      turned_ = "yaw_rate";
      add("derive", rotation, "turned upright");
    } else {
      add("derive", "", fmt::format("derive = {} gives the same by rotation", rotation));
    }
  }

  bool is_yaw_rate(const ChannelPlace& place) const {
    return guess_.mounting && channel(place).name == guess_.mounting->up_rate;
  }

  /// Names from topics are too long for tables and axes, so these channels get short names.
  void shorten(const std::vector<ChannelPlace>& places) {
    constexpr std::size_t longest = 24;
    for (const ChannelPlace& place : places) {
      const std::string& name = channel(place).name;
      if ((name.size() <= longest && !needs_quotes(name)) || short_names_.count(name) > 0 ||
          (is_yaw_rate(place) && !turned_.empty()))
        continue;
      std::string alias = is_yaw_rate(place) ? "yaw_rate" : short_name(name);
      const auto is_taken = [&](const std::string& candidate) {
        return table(place).find(candidate) != nullptr ||
               std::any_of(short_names_.begin(), short_names_.end(),
                           [&](const auto& n) { return n.second == candidate; });
      };
      while (is_taken(alias)) alias += "_";
      const std::string& own = channel(place).unit;
      std::string unit = own.empty() ? usual_unit(name) : own;
      if (unit.find(']') != std::string::npos) unit.clear();  // a ] in a unit would end the bracket around the unit
      add("derive", fmt::format("{}{} = {}", alias, unit.empty() ? "" : " [" + unit + "]", quoted_channel_name(name)),
          "");
      short_names_[name] = alias;
    }
  }

  std::string name_of(const ChannelPlace& place) const {
    if (is_yaw_rate(place) && !turned_.empty()) return turned_;
    const auto short_name = short_names_.find(channel(place).name);
    return short_name == short_names_.end() ? channel(place).name : short_name->second;
  }

  std::string names(const std::vector<ChannelPlace>& places) const {
    std::vector<std::string> all;
    for (const ChannelPlace& place : places) all.push_back(name_of(place));
    return listed_channel_names(all);
  }

  /// If the format has no units, takes them from the names. Empty unless every channel has one.
  void units(const char* key, const std::vector<ChannelPlace>& places) {
    std::vector<std::string> all;
    bool said = true;
    for (const ChannelPlace& place : places) {
      const std::string& own = channel(place).unit;
      said =
          said && (!own.empty() || (name_of(place) != channel(place).name && !usual_unit(channel(place).name).empty()));
      all.push_back(own.empty() ? usual_unit(channel(place).name) : own);
    }
    const auto cannot_be_listed = [](const std::string& unit) { return unit.empty() || needs_quotes(unit); };
    if (said || std::any_of(all.begin(), all.end(), cannot_be_listed)) return;
    const bool alike = std::count(all.begin(), all.end(), all.front()) == std::ssize(all);
    add(key, alike ? all.front() : fmt::format("{}", fmt::join(all, ", ")), "guessed from the names");
  }

  void channels() {
    for (const std::string& reason : guess_.reasons) doubt(reason);
    limits();
    shorten(guess_.states);
    shorten(guess_.inputs);
    add("state", names(guess_.states), "measured; the model predicts it");
    if (!guess_.inputs.empty()) add("input", names(guess_.inputs), "acts on the state");
    units("state_unit", guess_.states);
    if (!guess_.inputs.empty()) units("input_unit", guess_.inputs);
  }

  double repeated(const std::vector<ChannelPlace>& places) const {
    double least = 1.0;
    for (const ChannelPlace& place : places) least = std::min(least, channel(place).check.repeated);
    return places.empty() ? 0.0 : least;
  }

  /// A coarsely rounded value also repeats, but its source need not be slow.
  bool is_coarse(const ChannelPlace& place) const {
    constexpr double few = 200.0;
    const ChannelCheck& check = channel(place).check;
    return check.quantum > 0.0 && check.largest - check.least < few * check.quantum;
  }

  /// A common rate within 15 % of the given one, else the given rate rounded to two digits.
  static double round_rate(double rate_hz) {
    for (const double usual : {1.0, 2.0, 4.0, 5.0, 10.0, 20.0, 25.0, 30.0, 40.0, 50.0, 100.0})
      if (std::abs(rate_hz - usual) < 0.15 * usual) return usual;
    const double digit = std::pow(10.0, std::floor(std::log10(rate_hz)) - 1.0);
    return digit * std::round(rate_hz / digit);
  }

  void sampling() {
    const SamplingCheck& rows = table(input()).sampling;
    const double stale = repeated(guess_.states);
    if (stale > most_repeated && !is_coarse(state()) && rows.rate_hz > 0.0 && !table(input()).time.empty()) {
      const double fresh = rows.rate_hz * (1.0 - stale);
      const double rate = round_rate(fresh);
      add("rate_hz", fmt::format("{:g}", rate),
          fmt::format("{:.4g} rows per second; {:.0f} % of them repeat the state of the row before", rows.rate_hz,
                      100.0 * stale));
    }
    if (!one_table() && !guess_.inputs.empty())
      add("lag_s", "auto", "two instruments rarely share a clock, so the lag between them is estimated");
    bool missing = false, disordered = false, rounded = false;
    for (const std::vector<ChannelPlace>* places : {&guess_.states, &guess_.inputs})
      for (const ChannelPlace& place : *places) missing = missing || channel(place).check.missing > 0;
    for (const ChannelPlace& place : guess_.states) rounded = rounded || channel(place).check.quantum > 0.0;
    for (const ChannelPlace& place : {state(), input()})
      disordered = disordered || table(place).sampling.backward_times + table(place).sampling.repeated_times > 0;
    if (missing) add("missing", "gap", "some values are missing; runs are split there");
    if (disordered) add("disorder", "sort", "some times repeat or go backwards; rows are sorted by time");
    if (rounded && one_table()) add("quantum", "auto", "the state is rounded");
  }

  void runs() {
    if (!table(state()).run.empty()) {
      add("run", table(state()).run, "separates the runs in one file");
      return;
    }
    if (sets_[input().file].files.size() > 1) return;
    const FitOptions defaults;
    const std::string split = proposed_split(table(input()).sampling.samples, defaults.length + defaults.state_lags);
    const bool in_blocks = split.starts_with("blocks");
    add("split", split,
        in_blocks ? "one long run: blocks 1, 3, ... train, the others test" : "one run: its end is held out");
  }
};

}  // namespace

const ProposedKey* Proposal::find(const std::string& key) const {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const ProposedKey& k) { return k.key == key; });
  return found == keys.end() ? nullptr : &*found;
}

void Proposal::add(std::string key, std::string value, std::string why) {
  keys.push_back({std::move(key), std::move(value), std::move(why)});
}

void Proposal::doubt(const std::string& text) {
  if (std::count(doubts.begin(), doubts.end(), text) == 0) doubts.push_back(text);
}

void Proposal::drop(const std::string& key) {
  std::erase_if(keys, [&](const ProposedKey& k) { return k.key == key; });
}

void Proposal::set(const std::string& key, const std::string& value, const std::string& why) {
  drop(key);
  keys.push_back({key, value, why});
}

Proposal propose(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess,
                 const std::string& config_folder) {
  return Proposer(sets, surveyed, guess).propose(config_folder);
}

}  // namespace modebank::app
