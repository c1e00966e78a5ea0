#include "io/table/time_unit.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "ident/base/characters.hpp"
#include "io/table/name_unit.hpp"

namespace modebank {

namespace {

struct Unit {
  TimeUnit unit;
  std::int64_t ns;
  std::string_view plural;
  std::string_view words;  ///< a text of words, with blanks around each word
};

constexpr std::array units{
    Unit{TimeUnit::s, 1'000'000'000, "seconds", " s sec secs second seconds "},
    Unit{TimeUnit::ms, 1'000'000, "milliseconds", " ms msec msecs millis millisecond milliseconds "},
    Unit{TimeUnit::us, 1'000, "microseconds",
         " us usec usecs micros microsecond microseconds \xC2\xB5s \xCE\xBCs \xB5s "},
    Unit{TimeUnit::ns, 1, "nanoseconds", " ns nsec nsecs nanos nanosecond nanoseconds "},
    Unit{TimeUnit::min, 60'000'000'000, "minutes", " min mins minute minutes "},
    Unit{TimeUnit::h, 3'600'000'000'000, "hours", " h hr hrs hour hours "},
    Unit{TimeUnit::d, 86'400'000'000'000, "days", " d day days "},
};

const Unit& entry(TimeUnit unit) {
  const auto found = std::find_if(units.begin(), units.end(), [unit](const Unit& u) { return u.unit == unit; });
  return found == units.end() ? units.front() : *found;
}

std::optional<TimeUnit> unit_of_word(std::string_view word) {
  if (word.empty() || word.find(' ') != std::string_view::npos) return std::nullopt;
  std::string lower = " ";
  for (const char c : word) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  lower += ' ';
  const auto found = std::find_if(units.begin(), units.end(),
                                  [&](const Unit& u) { return u.words.find(lower) != std::string_view::npos; });
  return found == units.end() ? std::nullopt : std::optional(found->unit);
}

/// The part of a name from the last capital letter after a small letter: US in TimeUS.
std::string_view last_capitalised(std::string_view word) {
  for (std::size_t i = word.size(); i-- > 1;)
    if (is_upper(word[i]) && is_lower(word[i - 1])) return word.substr(i);
  return {};
}

/// The part of a name after a word that means time: ns in timestampns.
std::string_view behind_time(std::string_view word) {
  for (const std::string_view time : {"timestamp", "time", "stamp", "clock"})
    if (word.size() > time.size() + 1 && word.starts_with(time)) return word.substr(time.size());
  return {};
}

}  // namespace

std::int64_t ns_per(TimeUnit unit) { return entry(unit).ns; }

std::string_view in_words(TimeUnit unit) { return entry(unit).plural; }

std::optional<TimeUnit> stated_time_unit(std::string_view stated) {
  stated = bare_unit(stated);
  return unit_of_word(stated.substr(0, stated.find(" since ")));
}

std::optional<TimeUnit> named_time_unit(std::string_view name) {
  if (const std::string_view unit = split_unit(name).unit; !unit.empty()) return stated_time_unit(unit);
  while (!name.empty() && std::string_view(")] ").find(name.back()) != std::string_view::npos) name.remove_suffix(1);
  const std::size_t separator = name.find_last_of("_[( ./");
  const std::string_view word = separator == std::string_view::npos ? name : name.substr(separator + 1);
  if (name.size() < 2) return std::nullopt;  // a column with the name "s" may contain anything
  for (const std::string_view part : {word, last_capitalised(word), behind_time(word)})
    if (const auto unit = unit_of_word(part)) return unit;
  return std::nullopt;
}

}  // namespace modebank
