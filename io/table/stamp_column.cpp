#include "io/table/stamp_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr double largest_whole = 9.2e18;  // limit of 64-bit integers
constexpr double exact_below = 1e6;       // below this, a double represents billionths exactly

/// Whether a billionth of the unit is coarser than the precision of a double.
bool is_long(TimeUnit unit) { return ns_per(unit) > billion; }

std::optional<std::int64_t> nanoseconds_in(std::string_view text) {
  const std::optional<Stamp> stamp = parse_decimal_stamp(text);
  if (!stamp || stamp->billionths != 0 || stamp->whole < 0 || stamp->whole >= billion) return std::nullopt;
  return stamp->whole;
}

}  // namespace

StampColumn::StampColumn(const TimeRequest& request, std::string_view stated_unit)
    : request_(request), stated_unit_(stated_unit) {
  if (!request_.format.empty()) patterns_.emplace_back(request_.format);
}

void StampColumn::reserve(std::size_t rows) {
  stamps_.reserve(rows);
  as_written_.reserve(rows);
}

void StampColumn::push(Stamp stamp, double as_written) {
  kind_ = Kind::number;
  whole_numbers_ = whole_numbers_ && stamp.billionths == 0;
  stamps_.push_back(stamp);
  as_written_.push_back(as_written);
}

NumberStatus StampColumn::add(std::string_view text) {
  if (kind_ == Kind::text || !patterns_.empty()) return add_by_patterns(text);
  const ParsedNumber number = parse_number(text);
  if (number.status == NumberStatus::ok && !(std::abs(number.value) < largest_whole)) return NumberStatus::out_of_range;
  if (number.status == NumberStatus::ok) {
    const bool exact_anyway = std::abs(number.value) < exact_below;
    const std::optional<Stamp> exact = exact_anyway ? std::nullopt : parse_decimal_stamp(text);
    push(exact ? *exact : stamp_of(number.value), number.value);
    return NumberStatus::ok;
  }
  if (number.status != NumberStatus::text || kind_ == Kind::number) return number.status;
  return add_by_patterns(text);
}

NumberStatus StampColumn::add(std::string_view text, std::string_view second) {
  const ParsedNumber number = parse_number(text);
  if (number.status != NumberStatus::text && patterns_.empty() && kind_ != Kind::text) {
    if (number.status == NumberStatus::missing) return number.status;
    const std::optional<std::int64_t> fine = nanoseconds_in(second);
    if (!fine) return NumberStatus::text;
    if (const NumberStatus status = add(text); status != NumberStatus::ok) return status;
    if (stamps_.back().billionths != 0) return NumberStatus::text;  // error: the seconds already have a fraction
    stamps_.back().billionths = static_cast<std::int32_t>(*fine);
    return NumberStatus::ok;
  }
  return add(fmt::format("{} {}", without_blanks(text), without_blanks(second)));
}

NumberStatus StampColumn::add(double value) {
  if (!std::isfinite(value)) return NumberStatus::missing;
  if (!patterns_.empty()) return add_by_patterns(fmt::format("{}", value));
  if (!(std::abs(value) < largest_whole)) return NumberStatus::out_of_range;
  push(stamp_of(value), value);
  return NumberStatus::ok;
}

NumberStatus StampColumn::add(std::int64_t value) {
  if (!patterns_.empty()) return add_by_patterns(fmt::to_string(value));
  push({value, 0}, static_cast<double>(value));
  return NumberStatus::ok;
}

void StampColumn::add_missing() {
  as_written_.push_back(not_a_number);
  if (kind_ != Kind::text) stamps_.emplace_back();
  for (Reading& reading : readings_) reading.stamps.emplace_back();
}

/// Collects the patterns that fit the first text.
bool StampColumn::start_readings(std::string_view text) {
  for (const StampPattern& pattern : patterns_.empty() ? known_stamp_patterns() : patterns_)
    if (pattern.read(text)) readings_.push_back({pattern, std::vector<Stamp>(as_written_.size())});
  if (readings_.empty()) return false;
  kind_ = Kind::text;
  first_value_ = without_blanks(text);
  first_row_ = as_written_.size();
  return true;
}

NumberStatus StampColumn::add_by_patterns(std::string_view text) {
  const auto none = [&] {
    return parse_number(text).status == NumberStatus::missing ? NumberStatus::missing : NumberStatus::text;
  };
  if (readings_.empty() && !start_readings(text)) return none();
  std::size_t fitting = 0;
  for (Reading& reading : readings_) {
    const std::optional<Stamp> stamp = reading.pattern.read(text);
    reading.fits = stamp.has_value();
    if (!stamp) continue;
    reading.push(*stamp);
    ++fitting;
  }
  if (fitting == 0) return none();
  if (fitting < readings_.size()) std::erase_if(readings_, [](const Reading& reading) { return !reading.fits; });
  as_written_.push_back(0.0);
  return NumberStatus::ok;
}

void StampColumn::Reading::push(Stamp stamp) {
  if (!pattern.has_date()) stamp.whole = days.on(stamp.whole);
  stamps.push_back(stamp);
}

bool StampColumn::Reading::is_even(const std::vector<double>& missing) const {
  constexpr double gap_steps = 5.0;
  std::vector<double> steps;
  const Stamp* before = nullptr;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (std::isnan(missing[k])) continue;
    if (before != nullptr)
      steps.push_back(static_cast<double>(stamps[k].whole - before->whole) +
                      1e-9 * (stamps[k].billionths - before->billionths));
    before = &stamps[k];
  }
  if (steps.empty() || *std::min_element(steps.begin(), steps.end()) < 0.0) return steps.empty();
  const double longest = *std::max_element(steps.begin(), steps.end());
  return longest <= gap_steps * upper_median(steps);
}

std::string StampColumn::complaint(NumberStatus status, std::string_view text) const {
  if (status != NumberStatus::text) return unusable_number(status, text);
  const std::string shown = shown_field(text);
  if (!patterns_.empty()) return fmt::format("{} does not fit data.time_format = {}", shown, request_.format);
  if (!readings_.empty())
    return fmt::format("{} does not fit {}, as \"{}\" before it does (set data.time_format = PATTERN)", shown,
                       readings_.front().pattern.text(), first_value_);
  if (!request_.second.empty() && kind_ != Kind::text)
    return shown +
           " in two columns is not a time (whole seconds and nanoseconds below 1e9, or a date and a time of day)";
  return fmt::format(
      "{} is not a time (expected seconds, or a form such as 2024-05-01T10:00:00.25Z; set data.time_format for another "
      "form, such as %d.%m.%Y %H:%M:%S.%f)",
      shown);
}

/// A stated unit, or a unit in the column's name, takes precedence over the unit that the numbers indicate.
StampForm StampColumn::found_form(std::vector<std::string>& notes) const {
  using Ground = StampForm::Ground;
  if (!request_.second.empty()) return {Ground::stated, TimeUnit::s};
  if (request_.unit != TimeUnit::automatic) return {Ground::stated, request_.unit};
  StampForm form{Ground::stated, TimeUnit::s};
  const auto stated = stated_time_unit(stated_unit_), named = named_time_unit(request_.column);
  if (stated || named)
    form.unit = stated ? *stated : *named;
  else
    form = form_of_numbers(request_.column, as_written_, whole_numbers_, notes);
  if (stated && named && *stated != *named)
    notes.push_back(fmt::format("the name of {} says {}, but its unit {}, which is taken (data.time_unit)",
                                request_.column, in_words(*named), in_words(*stated)));
  if (form.unit != TimeUnit::s)
    notes.push_back(fmt::format("column {} counts {} (data.time_unit = {})", request_.column, in_words(form.unit),
                                name_of(form.unit)));
  return form;
}

std::int64_t StampColumn::nanoseconds(std::size_t row, const StampForm& form) const {
  const std::int64_t scale = ns_per(form.unit);
  if (is_long(form.unit))
    return std::llround((as_written_[row] - static_cast<double>(form.first_day)) * static_cast<double>(scale));
  return stamps_[row].whole * scale + stamps_[row].billionths / (billion / scale);
}

/// Prefers patterns whose stamps advance evenly. Patterns that give the same time for every stamp count as one.
void StampColumn::decide_reading(Table& table) {
  const auto uneven = [&](const Reading& reading) { return !reading.is_even(as_written_); };
  if (readings_.size() > 1 && !std::all_of(readings_.begin(), readings_.end(), uneven))
    std::erase_if(readings_, uneven);
  const Reading& chosen = readings_.front();
  table.form = {StampForm::Ground::text, TimeUnit::s, 0, {}, {}, first_value_, table.line[first_row_]};
  table.form.clock = !chosen.pattern.has_date();
  for (const Reading& reading : readings_) {
    const bool alike = &reading != &chosen && reading.stamps == chosen.stamps;
    (alike ? table.form.alike : table.form.patterns).push_back(reading.pattern.text());
  }
  table.time_ns.resize(as_written_.size());
  for (std::size_t k = 0; k < as_written_.size(); ++k)
    table.time_ns[k] =
        std::isnan(as_written_[k]) ? missing_stamp : chosen.stamps[k].whole * billion + chosen.stamps[k].billionths;
  if (!chosen.pattern.text().starts_with("%Y") && patterns_.empty())
    table.notes.push_back(
        fmt::format("column {} is read as {} (data.time_format)", request_.column, chosen.pattern.text()));
}

void StampColumn::finish(std::string_view file, Table& table) {
  if (kind_ == Kind::text) return decide_reading(table);
  table.form = found_form(table.notes);
  StampForm& form = table.form;
  if (kind_ == Kind::unknown) form.ground = StampForm::Ground::none;
  table.time_ns.assign(stamps_.size(), missing_stamp);
  const double most = largest_whole / static_cast<double>(ns_per(form.unit));
  double turns = 0.0, before = 0.0;
  for (std::size_t k = 0; k < stamps_.size(); ++k) {
    if (std::isnan(as_written_[k])) continue;
    // Whole numbers that fall by nearly 2^32 come from a counter of 32 bits.
    if (whole_numbers_ && before < 0x1p32 && before - as_written_[k] > 0x1.ep31) turns += 0x1p32;
    before = as_written_[k];
    as_written_[k] += turns;
    stamps_[k].whole += static_cast<std::int64_t>(turns);
    if (form.value.empty()) {
      form.value = fmt::format("{}", as_written_[k]);
      form.line = table.line[k];
      if (form.unit == TimeUnit::d) form.first_day = first_day_of(as_written_[k]);
    }
    if (!(std::abs(as_written_[k] - static_cast<double>(form.first_day)) < most))
      throw DataError(fmt::format("{}:{}: column {}: {} {} is not a time (data.time_unit)", file, table.line[k],
                                  request_.column, as_written_[k], in_words(form.unit)));
    table.time_ns[k] = nanoseconds(k, form);
  }
  if (turns > 0.0)
    table.notes.push_back(fmt::format("{} falls by 2^32, as 32-bit counters do: it is counted on", request_.column));
  if (form.unit == TimeUnit::s && request_.second.empty()) table.time_s = std::move(as_written_);
}

}  // namespace modebank
