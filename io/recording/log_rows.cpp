#include "io/recording/log_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Form = LogWant::Form;

constexpr std::size_t receive_time = ~std::size_t{0};  // the receive time has its own slot, because it is not part of
                                                       // the message

std::string written_out(const Value& value) {
  switch (value.form) {
    case Value::Form::missing:
      return {};
    case Value::Form::text:
      return value.text;
    case Value::Form::integer:
      return fmt::format("{}", value.exact);
    case Value::Form::natural:
      return fmt::format("{}", static_cast<std::uint64_t>(value.exact));
    case Value::Form::real:
    case Value::Form::time:
      break;
  }
  return fmt::format("{}", value.number);
}

Value time_value(std::int64_t nanoseconds) {
  constexpr std::int64_t second = 1'000'000'000;
  Value value;
  value.form = Value::Form::time;
  value.exact = nanoseconds;
  value.number = static_cast<double>(nanoseconds / second) + static_cast<double>(nanoseconds % second) / 1e9;
  return value;
}

bool is_rounded(const Value& value) {
  constexpr double exact_to = 9007199254740992.0;  // 2^53: all integers up to this are exact in a double
  return (value.form == Value::Form::integer || value.form == Value::Form::natural) &&
         std::abs(value.number) > exact_to;
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::size_t>& order) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::size_t i : order) sorted.push_back(std::move(values[i]));
  values = std::move(sorted);
}

}  // namespace

RowCollector::RowCollector(const LogTopic& topic, const LogRequest& request)
    : topic_(topic), request_(request), rounded_(request.columns.size()) {
  rows_.columns.resize(request.columns.size());
}

std::size_t RowCollector::add_reader(const TopicDecoder& decoder) {
  Reader reader{MessageReader(decoder.schema, decoder.wide_bytes), {}};
  for (const LogWant& want : request_.columns) {
    const std::string prefix = topic_.name + ".";
    const bool of_topic = want.column.compare(0, prefix.size(), prefix) == 0;
    const std::string path = of_topic ? want.column.substr(prefix.size()) : "";
    if (path == "receive_time") {
      reader.slots.push_back(receive_time);
      continue;
    }
    if (!decoder.schema)
      throw DataError(fmt::format("topic {} ({}) cannot be read: {}", topic_.name, topic_.type, decoder.problem));
    try {
      reader.slots.push_back(reader.messages.add(path));
      if (path.find('{') != std::string::npos) reader.named.push_back(reader.slots.back());
    } catch (const DefinitionError&) {
      throw ConfigurationError(
          fmt::format("topic {} ({}) has no column \"{}\"", topic_.name, topic_.type, want.column));
    }
  }
  readers_.push_back(std::move(reader));
  return readers_.size() - 1;
}

void RowCollector::take(std::size_t reader, const RecordedMessage& message, const std::string& file) {
  const Reader& chosen = readers_[reader];
  ++messages_;
  const bool decoded =
      std::any_of(chosen.slots.begin(), chosen.slots.end(), [](auto slot) { return slot != receive_time; });
  try {
    if (decoded) chosen.messages.read(message.payload, row_);
  } catch (const PayloadError& error) {
    throw DataError(fmt::format("{}:{}: topic {} ({}): the definition does not fit the message: {}", file, messages_,
                                topic_.name, topic_.type, error.what()));
  }
  const auto is_missing = [&](std::size_t slot) { return row_[slot].form == Value::Form::missing; };
  // A message without any of the requested names is another publisher's.
  if (!chosen.named.empty() && std::ranges::all_of(chosen.named, is_missing)) return;
  rows_.message.push_back(messages_);
  receive_ns_.push_back(message.receive_ns);
  for (std::size_t i = 0; i < chosen.slots.size(); ++i) {
    const std::size_t slot = chosen.slots[i];
    const Value& value = slot == receive_time ? time_value(message.receive_ns) : row_[slot];
    if (request_.columns[i].form == Form::number && is_rounded(value)) ++rounded_[i];
    append(rows_.columns[i], request_.columns[i], value, file);
  }
}

void RowCollector::append(LogColumn& column, const LogWant& want, const Value& value, const std::string& file) {
  const auto fail = [&](const char* why) {
    throw DataError(fmt::format("{}:{}: column {}: {}", file, messages_, want.column, why));
  };
  const bool missing = value.form == Value::Form::missing;
  switch (want.form) {
    case Form::text:
      return column.text.push_back(written_out(value));
    case Form::number:
      if (value.form == Value::Form::text) fail("text in place of a number");
      return column.numbers.push_back(missing ? std::numeric_limits<double>::quiet_NaN() : value.number);
    case Form::exact:
      if (value.form == Value::Form::text) fail("text in place of a number");
      if (value.form == Value::Form::real) return column.numbers.push_back(value.number);
      if (value.form == Value::Form::natural && value.exact < 0) fail("a number beyond 2^63 - 1");
      return column.exact.push_back(missing ? no_exact_value : value.exact);
  }
}

LogRows RowCollector::finish(std::vector<std::string>& notes) {
  for (std::size_t i = 0; i < rounded_.size(); ++i)
    if (rounded_[i] > 0)
      notes.push_back(fmt::format("column {}: {} values above 2^53 are rounded to the nearest double",
                                  request_.columns[i].column, rounded_[i]));
  if (!std::is_sorted(receive_ns_.begin(), receive_ns_.end())) {
    std::vector<std::size_t> order(receive_ns_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return receive_ns_[a] < receive_ns_[b]; });
    reorder(rows_.message, order);
    for (LogColumn& column : rows_.columns) {
      reorder(column.numbers, order);
      reorder(column.text, order);
      reorder(column.exact, order);
    }
  }
  return std::move(rows_);
}

}  // namespace modebank
