#include "io/recording/message_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "io/recording/skip_field.hpp"

namespace modebank {

namespace {

bool is_blob(Kind kind, std::uint64_t count) {
  return bytes_of(kind) == 1 && kind != Kind::boolean && count > most_elements;
}

MessageColumn::Form form_of(Kind kind) {
  if (kind == Kind::string || kind == Kind::wstring) return MessageColumn::Form::text;
  return kind == Kind::time ? MessageColumn::Form::time : MessageColumn::Form::number;
}

/// Walks through one message and lists its columns.
class Listing {
 public:
  explicit Listing(PayloadReader& payload) : payload_(payload) {}

  void list(const MessageType& type, const std::string& prefix) {
    if (type.fields.empty()) return payload_.empty_type();
    std::vector<std::string> names;                   // entries of the array `name`
    std::vector<std::pair<std::string, Kind>> keyed;  // arrays that have the same number of values as `name`
    for (const Field& field : type.fields) {
      const std::string path = prefix + field.name;
      if (field.many == Many::one) {
        list_one(field, path);
        continue;
      }
      const std::uint64_t count = length_of(field, payload_);
      if (field.name == "name" && field.kind == Kind::string)
        names = list_names(path, count);
      else {
        list_array(field, path, count);
        if (!names.empty() && count == names.size() && field.kind != Kind::message && field.kind != Kind::wstring)
          keyed.emplace_back(path, field.kind);
      }
    }
    for (const auto& [path, kind] : keyed)
      for (const std::string& name : names) add(fmt::format("{}{{{}}}", path, name), kind);
  }

  std::vector<MessageColumn> columns;

 private:
  void add(std::string path, Kind kind) {
    if (columns.size() < most_columns) columns.push_back({std::move(path), form_of(kind)});
  }

  void list_one(const Field& field, const std::string& path) {
    if (field.kind == Kind::message) return list(*field.type, path + ".");
    add(path, field.kind);
    payload_.skip(field.kind, 1);
  }

  void list_array(const Field& field, const std::string& path, std::uint64_t count) {
    if (is_blob(field.kind, count)) return payload_.skip(field.kind, count);
    const std::uint64_t listed = std::min(count, most_elements);
    for (std::uint64_t i = 0; i < listed; ++i) list_one(field, fmt::format("{}[{}]", path, i));
    skip_elements(field, count - listed, payload_);
  }

  /// If a name occurs twice, names cannot identify elements. Then no names are returned.
  std::vector<std::string> list_names(const std::string& path, std::uint64_t count) {
    std::vector<std::string> names;
    Value value;
    for (std::uint64_t i = 0; i < count; ++i) {
      payload_.read(Kind::string, value);
      if (i >= most_elements) continue;
      add(fmt::format("{}[{}]", path, i), Kind::string);
      names.push_back(value.text);
    }
    const std::set<std::string> distinct(names.begin(), names.end());
    const bool usable = count <= most_elements && distinct.size() == names.size() &&
                        std::none_of(names.begin(), names.end(), [](const std::string& name) {
                          return name.empty() || name.find_first_of("{}") != std::string::npos;
                        });
    if (!usable) names.clear();
    return names;
  }

  PayloadReader& payload_;
};

}  // namespace

std::vector<MessageColumn> columns_of(const Schema& schema, std::string_view payload, unsigned wide_bytes) {
  PayloadReader reader(payload, schema.dialect(), wide_bytes);
  Listing listing(reader);
  listing.list(schema.root(), "");
  if (!reader.consumed())
    throw PayloadError(fmt::format("it continues at byte {}, where the definition ends", reader.at()));
  return std::move(listing.columns);
}

void merge_columns(std::vector<MessageColumn>& columns, const std::vector<MessageColumn>& more) {
  std::set<std::string> known;
  for (const MessageColumn& column : columns) known.insert(column.path);
  std::size_t place = 0;  // placed after the previous column, so that the elements of an array stay together
  for (const MessageColumn& column : more) {
    if (known.count(column.path) > 0) {
      const auto at =
          std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.path == column.path; });
      place = static_cast<std::size_t>(at - columns.begin()) + 1;
    } else if (columns.size() < most_columns) {
      columns.insert(columns.begin() + static_cast<std::ptrdiff_t>(place++), column);
    }
  }
}

}  // namespace modebank
