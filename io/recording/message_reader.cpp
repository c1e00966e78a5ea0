#include "io/recording/message_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "io/recording/skip_field.hpp"

namespace modebank {

namespace {

[[noreturn]] void fail(const MessageType& type, std::string_view path) {
  throw DefinitionError(fmt::format("{} has no value \"{}\"", type.name, path));
}

/// The array field whose elements have the names in the neighbouring array `name`.
const Field* names_field(const MessageType& type) {
  for (const Field& field : type.fields)
    if (field.name == "name" && field.kind == Kind::string && field.many != Many::one) return &field;
  return nullptr;
}

std::vector<std::string> read_names(const MessageType& type, PayloadReader payload) {
  const Field* const wanted = names_field(type);
  for (const Field& field : type.fields) {
    if (&field != wanted) {
      skip_field(field, payload);
      continue;
    }
    std::vector<std::string> names;
    Value value;
    for (std::uint64_t left = length_of(field, payload); left > 0; --left) {
      payload.read(Kind::string, value);
      names.push_back(value.text);
    }
    return names;
  }
  return {};
}

}  // namespace

std::uint64_t length_of(const Field& field, PayloadReader& payload) {
  const std::uint64_t least = field.kind == Kind::message ? field.type->least_bytes
                              : bytes_of(field.kind) > 0  ? bytes_of(field.kind)
                                                          : 4;
  const std::uint64_t count = field.many == Many::sequence ? payload.sequence_length(least) : field.count;
  if (field.many == Many::fixed) payload.check_room(least, count);
  return count;
}

void skip_elements(const Field& field, std::uint64_t count, PayloadReader& payload) {
  if (field.kind != Kind::message) return payload.skip(field.kind, count);
  if (field.type->least_bytes == 0) return;  // the elements have no bytes
  for (std::uint64_t i = 0; i < count; ++i) {
    if (field.type->fields.empty()) payload.empty_type();
    for (const Field& inner : field.type->fields) skip_field(inner, payload);
  }
}

void skip_field(const Field& field, PayloadReader& payload) {
  skip_elements(field, field.many == Many::one ? 1 : length_of(field, payload), payload);
}

MessageReader::MessageReader(std::shared_ptr<const Schema> schema, unsigned wide_bytes)
    : schema_(std::move(schema)), wide_bytes_(wide_bytes) {}

std::size_t MessageReader::add(std::string_view path) { return add_field(root_, schema_->root(), path, path); }

std::size_t MessageReader::add_field(Want& want, const MessageType& type, std::string_view path,
                                     std::string_view whole) {
  const std::size_t end = std::min(path.find_first_of(".[{"), path.size());
  const auto field = std::find_if(type.fields.begin(), type.fields.end(),
                                  [&](const Field& candidate) { return candidate.name == path.substr(0, end); });
  if (field == type.fields.end()) fail(schema_->root(), whole);
  Want& inner = want.fields[static_cast<std::size_t>(field - type.fields.begin())];
  path.remove_prefix(end);
  if (field->many == Many::one) return add_one(inner, *field, path, whole);
  if (path.empty() || path.front() == '.') fail(schema_->root(), whole);
  const bool keyed = path.front() == '{';
  const std::size_t close = path.find(keyed ? '}' : ']');
  if (close == std::string_view::npos || (keyed && !names_field(type))) fail(schema_->root(), whole);
  const std::string_view key = path.substr(1, close - 1);
  path.remove_prefix(close + 1);
  if (keyed) return add_one(inner.keyed.try_emplace(std::string(key)).first->second, *field, path, whole);
  std::uint64_t index = 0;
  const auto [rest, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  if (error != std::errc() || rest != key.data() + key.size() || (field->many == Many::fixed && index >= field->count))
    fail(schema_->root(), whole);
  return add_one(inner.elements[index], *field, path, whole);
}

std::size_t MessageReader::add_one(Want& want, const Field& field, std::string_view path, std::string_view whole) {
  if (field.kind == Kind::message) {
    if (path.empty() || path.front() != '.') fail(schema_->root(), whole);
    return add_field(want, *field.type, path.substr(1), whole);
  }
  if (!path.empty()) fail(schema_->root(), whole);
  if (want.slot == Want::none) want.slot = slots_++;
  return want.slot;
}

void MessageReader::read(std::string_view bytes, std::vector<Value>& row) const {
  row.resize(slots_);
  for (Value& value : row) value.form = Value::Form::missing;
  PayloadReader payload(bytes, schema_->dialect(), wide_bytes_);
  read_message(schema_->root(), root_, payload, row);
  if (!payload.consumed())
    throw PayloadError(fmt::format("it continues at byte {}, where the definition ends", payload.at()));
}

void MessageReader::read_message(const MessageType& type, const Want& want, PayloadReader& payload,
                                 std::vector<Value>& row) {
  if (type.fields.empty()) return payload.empty_type();
  std::vector<std::string> names;
  const bool by_name = std::any_of(want.fields.begin(), want.fields.end(),
                                   [](const auto& field) { return !field.second.keyed.empty(); });
  if (by_name) names = read_names(type, payload);
  auto wanted = want.fields.begin();
  for (std::size_t i = 0; i < type.fields.size(); ++i) {
    const Field& field = type.fields[i];
    if (wanted == want.fields.end() || wanted->first != i) {
      skip_field(field, payload);
      continue;
    }
    if (field.many == Many::one)
      read_one(field, wanted->second, payload, row);
    else
      read_array(field, wanted->second, names, payload, row);
    ++wanted;
  }
}

void MessageReader::read_one(const Field& field, const Want& want, PayloadReader& payload, std::vector<Value>& row) {
  if (field.kind == Kind::message)
    read_message(*field.type, want, payload, row);
  else
    payload.read(field.kind, row[want.slot]);
}

void MessageReader::read_array(const Field& field, const Want& want, const std::vector<std::string>& names,
                               PayloadReader& payload, std::vector<Value>& row) {
  std::uint64_t next = 0;
  const std::uint64_t count = length_of(field, payload);
  // An element that is requested both by index and by name is read twice.
  std::multimap<std::uint64_t, const Want*> wanted;
  for (const auto& [index, element] : want.elements)
    if (index < count) wanted.emplace(index, &element);
  for (const auto& [name, element] : want.keyed) {
    const auto index = static_cast<std::uint64_t>(std::find(names.begin(), names.end(), name) - names.begin());
    if (index < names.size() && index < count) wanted.emplace(index, &element);
  }
  PayloadReader element = payload;
  for (const auto& [index, inner] : wanted) {
    if (index >= next) {
      skip_elements(field, index - next, payload);
      element = payload;
      skip_elements(field, 1, payload);
      next = index + 1;
    }
    PayloadReader again = element;
    read_one(field, *inner, again, row);
  }
  skip_elements(field, count - next, payload);
}

}  // namespace modebank
