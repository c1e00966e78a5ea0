#include "app/init/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "ident/base/characters.hpp"
#include "ident/base/printable.hpp"
#include "io/csv/csv_number.hpp"
#include "io/table/name_unit.hpp"

namespace modebank::app {
namespace {

/// Points for a name that contains a sequence of words.
struct Word {
  std::string_view words;  ///< with a blank before and after
  int points;
};

/// Only the word with the most points counts. Otherwise "angular velocity z" would score once for each of its words.
int best(std::span<const Word> list, std::string_view words) {
  int points = 0;
  for (const Word& word : list)
    if (words.find(word.words) != std::string_view::npos && word.points > points) points = word.points;
  return points;
}

constexpr std::array state_words{
    Word{" wz ", 6},          Word{" omega z ", 6},  Word{" yaw rate ", 6},
    Word{" yawrate ", 6},     Word{" gyro z ", 6},   Word{" angular velocity z ", 6},
    Word{" angular z ", 5},   Word{" gyro ", 3},     Word{" level ", 5},
    Word{" temperature ", 5}, Word{" temp ", 4},     Word{" output ", 5},
    Word{" y ", 3},           Word{" y1 ", 5},       Word{" y 1 ", 4},
    Word{" response ", 5},    Word{" x ", 2},        Word{" measured ", 4},
    Word{" meas ", 4},        Word{" sensor ", 3},   Word{" vx ", 4},
    Word{" linear x ", 4},    Word{" speed ", 3},    Word{" velocity ", 3},
    Word{" vel ", 3},         Word{" rate ", 2},     Word{" acceleration ", 2},
    Word{" state ", 3},       Word{" angle ", 2},    Word{" position ", 1},
    Word{" pressure ", 4},    Word{" flow ", 3},     Word{" gz ", 5},
    Word{" heading ", 3},     Word{" yaw ", 2},      Word{" roll rate ", 5},
    Word{" pitch rate ", 5},  Word{" altitude ", 1}, Word{" velocities ", 3},
    Word{" alt ", 1},         Word{" ewe ", 5},      Word{" pv ", 5},
};

constexpr std::array input_words{
    Word{" cmd ", 8},       Word{" command ", 8},  Word{" commanded ", 8}, Word{" setpoint ", 8},
    Word{" set point ", 8}, Word{" desired ", 7},  Word{" target ", 7},    Word{" demand ", 7},
    Word{" reference ", 6}, Word{" ref ", 6},      Word{" throttle ", 7},  Word{" steer ", 7},
    Word{" steering ", 7},  Word{" brake ", 7},    Word{" pedal ", 7},     Word{" pwm ", 7},
    Word{" duty ", 7},      Word{" voltage ", 6},  Word{" torque ", 6},    Word{" effort ", 5},
    Word{" pump ", 6},      Word{" valve ", 6},    Word{" heater ", 6},    Word{" control ", 6},
    Word{" input ", 6},     Word{" u ", 6},        Word{" u1 ", 6},        Word{" u2 ", 6},
    Word{" u 1 ", 6},       Word{" u 2 ", 6},      Word{" wheel ", 5},     Word{" vel l ", 5},
    Word{" vel r ", 5},     Word{" v l ", 5},      Word{" v r ", 5},       Word{" left ", 4},
    Word{" right ", 4},     Word{" motor ", 5},    Word{" joy ", 5},       Word{" cur ", 2},
    Word{" current ", 2},   Word{" linear x ", 2}, Word{" angular z ", 2}, Word{" wz ", 2},
    Word{" speed ", 2},     Word{" vx ", 2},       Word{" rudder ", 7},    Word{" helm ", 6},
    Word{" aileron ", 7},   Word{" elevator ", 7}, Word{" fan ", 6},       Word{" force ", 6},
    Word{" thrust ", 7},    Word{" power ", 5},    Word{" drive ", 4},     Word{" actuator ", 7},
    Word{" co ", 4},        Word{" op ", 4},       Word{" mv ", 4},        Word{" tau ", 5},
};

/// Points that all channels of a table get for the table's name.
constexpr std::array measuring_tables{Word{" imu ", 3}, Word{" gyro ", 3}, Word{" odom ", 1}, Word{" odometry ", 1}};
constexpr std::array acting_tables{
    Word{" cmd ", 8},      Word{" command ", 8}, Word{" commands ", 8}, Word{" joy ", 3},     Word{" odom ", 2},
    Word{" odometry ", 2}, Word{" joint ", 2},   Word{" wheel ", 4},    Word{" encoder ", 4}, Word{" encoders ", 4}};

constexpr std::array ignored_words{
    " covariance ", " seq ",       " frame id ",     " status ", " stamp ", " secs ",    " nsecs ",    " sec ",
    " nanosec ",    " timestamp ", " receive time ", " row ",    " index ", " done ",    " latitude ", " longitude ",
    " checksum ",   " lat ",       " lon ",          " crc ",    " label ", " mode ",    " qx ",       " qy ",
    " qz ",         " qw ",        " orientation ",  " step ",   " count ", " counter ", " steady ",   " window ",
    " friction ",   " ground ",    " true ",         " truth ",  " gt ",    " vicon ",   " mocap ",    " optitrack ",
    " icp ",        " flag ",      " jump ",         " header ",
};
/// An id that is not the last word belongs to the name of a matrix: resultID[0].
constexpr std::array ignored_endings{" id ",        " terminal ", " terminals ", " terminated ",
                                     " truncated ", " timeout ",  " timeouts "};

constexpr std::array time_names{" time ",      " t ",       " stamp ",   " timestamp ",     " tout ",
                                " secs ",      " seconds ", " sec ",     " sampling time ", " zeit ",
                                " clock ",     " time s ",  " t s ",     " header stamp ",  " time ns ",
                                " time ms ",   " time us ", " t block ", " stamp ns ",      " header stamp secs ",
                                " time min ",  " time h ",  " hours ",   " minutes ",       " datetime ",
                                " date time ", " date ",    " elapsed ", " uptime ",        " timestamps ",
                                " micros ",    " millis ",  " t ms ",    " t us ",          " t ns "};
constexpr std::array run_names{" run ",        " run id ",  " block ",    " trial ",     " episode ",
                               " experiment ", " segment ", " sequence ", " file ",      " session ",
                               " lap ",        " demo ",    " traj ",     " trajectory "};
constexpr std::array set_point_words{" setpoint ",  " set point ", " sp ",  " desired ", " target ",
                                     " reference ", " ref ",       " des ", " soll "};

using Words = std::span<const char* const>;

bool any_of(Words list, std::string_view words) {
  return std::ranges::any_of(list, [&](const char* word) { return words.find(word) != std::string_view::npos; });
}

bool ends_with_any(Words list, std::string_view words) {
  return std::ranges::any_of(list, [&](const char* word) { return words.ends_with(word); });
}

bool is_one_of(std::initializer_list<std::string_view> units, std::string_view unit) {
  return std::ranges::find(units, unit) != units.end();
}

/// Whether a name ends with one of these words and the letter of this axis.
bool has_axis(std::string_view name, Axis axis, std::initializer_list<const char*> before) {
  const std::string words = words_of_name(name);
  const char letter = "xyz"[static_cast<std::size_t>(axis)];
  return std::ranges::any_of(before,
                             [&](const char* word) { return words.ends_with(fmt::format("{}{} ", word, letter)); });
}

}  // namespace

std::string words_of_name(std::string_view name) {
  name = split_unit(name).name;  // words in a unit give no points
  if (const std::size_t slash = name.rfind('/'); slash != std::string_view::npos && slash > 0)
    if (is_one_of({"V", "mV", "A", "mA", "mA.h", "Ah", "W", "Nm", "rpm", "bar", "%", "C", "°C", "K", "s", "ms", "h"},
                  name.substr(slash + 1)))
      name = name.substr(0, slash);
  std::string words = " ";
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i], before = i > 0 ? name[i - 1] : '\0';
    const bool starts =
        (is_upper(c) && is_lower(before)) || (is_digit(c) && is_letter(before) && i > 1 && is_letter(name[i - 2]));
    const bool letter = is_letter(c) || is_digit(c);
    if ((starts || !letter) && words.back() != ' ') words += ' ';
    if (letter) words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (words.back() != ' ') words += ' ';
  return words;
}

NameScore score_name(std::string_view name, std::string_view type) {
  const std::string words = words_of_name(name), kind = words_of_name(type);
  NameScore score;
  score.ignored = any_of(ignored_words, words) || ends_with_any(ignored_endings, words) || names_time(name) ||
                  names_nanoseconds(name);
  score.state = best(state_words, words);
  const bool acts = name != "U" && name.find("batt") == std::string_view::npos;  // U is often a constant speed
  score.input = words == " i " ? 4 : acts ? best(input_words, words) : 0;
  if (score.state > 0) score.state += std::max(best(measuring_tables, words), best(measuring_tables, kind));
  if (const int table = std::max(best(acting_tables, words), best(acting_tables, kind)); score.input > 0 || table > 4)
    score.input += table;                  // the channels of a command act, whatever their names
  if (score.input >= 10) score.state = 0;  // a command, even if the quantity is usually measured
  return score;
}

bool names_time(std::string_view name) { return ends_with_any(time_names, words_of_name(name)); }
bool names_run(std::string_view name) { return ends_with_any(run_names, words_of_name(name)); }

std::string words_without(Words list, std::string_view name) {
  std::string words = words_of_name(name);
  for (const std::string_view word : list)
    if (const std::size_t at = words.find(word); at != std::string::npos) return words.replace(at, word.size(), " ");
  return {};
}

std::string words_of_measured(std::string_view name) { return words_without(set_point_words, name); }

bool names_nanoseconds(std::string_view name) {
  constexpr std::array names{" nsecs ", " nsec ", " nanosec ", " nanosecs ", " nanoseconds ", " ns "};
  return ends_with_any(names, words_of_name(name));
}

std::string usual_unit(std::string_view name) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    if (names_angular_rate(name, axis)) return "rad/s";
    if (names_acceleration(name, axis)) return "m/s^2";
  }
  constexpr std::array rates{" yaw rate ", " yawrate "};
  constexpr std::array speeds{" linear x ", " linear y ", " vx ", " vel l ", " vel r ", " speed "};
  const std::string words = words_of_name(name);
  if (ends_with_any(rates, words)) return "rad/s";
  return ends_with_any(speeds, words) ? "m/s" : "";
}

bool names_angular_rate(std::string_view name, Axis axis) {
  return has_axis(name, axis, {" w", " g", " gyro ", " angular velocity ", " angular ", " omega ", " gyro"});
}

bool names_acceleration(std::string_view name, Axis axis) {
  return has_axis(name, axis, {" a", " acc ", " linear acceleration ", " accel ", " acceleration "});
}

bool names_position(std::string_view name, Axis axis) {
  return has_axis(name, axis, {"pos ", "position "}) ||
         (words_of_name(name).size() == 3 && has_axis(name, axis, {" "}));
}

bool unit_of_measured(std::string_view unit) {
  return is_one_of({"rad/s", "deg/s", "°/s", "degC", "°C", "K", "m/s^2", "m/s2", "m/s²", "rad", "deg", "bar"}, unit);
}

bool unit_of_acting(std::string_view unit) {
  return is_one_of({"V", "A", "%", "N", "Nm", "N m", "N.m", "W", "rpm"}, unit);
}

std::string why_no_numbers(const std::vector<std::string>& texts) {
  const std::string *like_number = nullptr, *first = nullptr;
  bool numbers = false;
  std::size_t changes = 0;
  for (const std::string& text : texts) {
    const NumberStatus status = parse_number(text).status;
    numbers = numbers || status == NumberStatus::ok;
    changes += &text != &texts.front() && text != *(&text - 1) ? 1 : 0;
    if (status != NumberStatus::text) continue;
    if (first == nullptr) first = &text;
    if (like_number == nullptr && text.find_first_of("0123456789") < 2) like_number = &text;
  }
  if (first == nullptr || changes == 0) return "";
  const std::string& text = like_number != nullptr ? *like_number : *first;
  constexpr std::size_t longest = 30;
  const MarkShown mark = like_number != nullptr ? mark_shown(text) : MarkShown::none;
  const bool comma = mark == MarkShown::comma || mark == MarkShown::either_comma;
  std::string hint;
  if (comma || mark == MarkShown::either_point)
    hint = fmt::format(": other numbers have a decimal {} (data.decimal)", comma ? "point" : "comma");
  else if (numbers)
    hint = ", although other values are (data.na lists words for missing values)";
  else if (2 * changes > texts.size() && 10 * std::set(texts.begin(), texts.end()).size() < texts.size())
    hint = changing_text;
  return fmt::format("\"{}\" is not a number{}", printable_name(text.substr(0, longest)), hint);
}

}  // namespace modebank::app
