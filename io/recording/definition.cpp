#include "io/recording/definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <set>
#include <utility>

#include "ident/base/characters.hpp"
#include "io/table/number.hpp"

namespace modebank {

namespace {

constexpr int deepest_nesting = 32;
constexpr std::size_t most_fields = 4096;  // limit for the number of fields of one type

/// Removes the first line from the text. Returns it without its line end.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

std::string_view next_word(std::string_view& text) {
  text = without_blanks(text);
  const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
  const std::string_view word = text.substr(0, end);
  text = without_blanks(text.substr(end));
  return word;
}

bool is_identifier(std::string_view name) {
  constexpr std::size_t longest = 256;
  return !name.empty() && name.size() <= longest &&
         std::all_of(name.begin(), name.end(), [](char c) { return c == '_' || is_digit(c) || is_letter(c); });
}

std::optional<Kind> primitive(std::string_view name, Dialect dialect) {
  constexpr std::array<std::pair<std::string_view, Kind>, 14> common{{{"bool", Kind::boolean},
                                                                      {"int8", Kind::int8},
                                                                      {"uint8", Kind::uint8},
                                                                      {"int16", Kind::int16},
                                                                      {"uint16", Kind::uint16},
                                                                      {"int32", Kind::int32},
                                                                      {"uint32", Kind::uint32},
                                                                      {"int64", Kind::int64},
                                                                      {"uint64", Kind::uint64},
                                                                      {"float32", Kind::float32},
                                                                      {"float64", Kind::float64},
                                                                      {"string", Kind::string},
                                                                      {"wstring", Kind::wstring},
                                                                      {"char", Kind::uint8}}};
  for (const auto& [word, kind] : common)
    if (word == name) return kind;
  const bool ros1 = dialect == Dialect::ros1;
  if (name == "byte") return ros1 ? Kind::int8 : Kind::uint8;
  if (name == (ros1 ? "time" : "builtin_interfaces/Time")) return Kind::time;
  if (name == (ros1 ? "duration" : "builtin_interfaces/Duration")) return Kind::duration;
  return {};
}

std::uint64_t saturated_product(std::uint64_t a, std::uint64_t b) {
  constexpr auto most = std::numeric_limits<std::uint64_t>::max() / 2;
  return b != 0 && a > most / b ? most : a * b;
}

std::uint64_t least_bytes(const Field& field) {
  if (field.many == Many::sequence) return 4;
  const bool text = field.kind == Kind::string || field.kind == Kind::wstring;
  const std::uint64_t one = field.kind == Kind::message ? field.type->least_bytes : text ? 4 : bytes_of(field.kind);
  return saturated_product(one, field.count);
}

/// Removes the brackets of "T[3]", "T[]" or "T[<=3]" from a type.
void parse_array(std::string_view& type, Field& field) {
  const std::size_t open = type.find('[');
  if (open == std::string_view::npos) return;
  std::string_view count = type.substr(open + 1);
  if (count.empty() || count.back() != ']') throw DefinitionError(fmt::format("\"{}\" is not a type", type));
  count.remove_suffix(1);
  type = type.substr(0, open);
  field.many = Many::sequence;
  if (count.empty() || count.substr(0, 2) == "<=") return;
  field.many = Many::fixed;
  const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), field.count);
  if (error != std::errc() || end != count.data() + count.size() || field.count > std::uint64_t{1} << 32)
    throw DefinitionError(fmt::format("[{}] is not the size of an array", count));
}

/// The type's name in the form that is used to find its definition.
std::string full_name(std::string_view type, const std::string& package, Dialect dialect) {
  if (type.find('/') != std::string_view::npos) return short_type(type);
  if (type == "Header" && dialect == Dialect::ros1) return "std_msgs/Header";
  return fmt::format("{}/{}", package, type);
}

std::string field_text(const Field& field) {
  const std::string type = field.type ? field.type->name : fmt::format("{}", static_cast<int>(field.kind));
  return fmt::format("  {} {} {} {}\n", type, static_cast<int>(field.many), field.count, field.name);
}

}  // namespace

std::uint64_t bytes_of(Kind kind) {
  constexpr std::array<std::uint8_t, 16> bytes{1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 0, 0, 8, 8, 0};
  return bytes[static_cast<std::size_t>(kind)];
}

std::string short_type(std::string_view type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  if (first == last) return std::string(type);
  return fmt::format("{}{}", type.substr(0, first), type.substr(last));
}

std::map<std::string, std::string_view> split_definitions(const std::string& root, std::string_view text) {
  std::map<std::string, std::string_view> parts;
  std::string name = root;
  const char* begin = text.data();
  const auto close = [&](const char* end) {
    if (!name.empty()) parts.emplace(name, std::string_view(begin, static_cast<std::size_t>(end - begin)));
  };
  while (!text.empty()) {
    const char* line_begin = text.data();
    const std::string_view line = without_blanks(next_line(text));
    if (line.substr(0, 4) != "MSG:" && line.substr(0, 3) != "===") continue;
    close(line_begin);
    name = line.front() == '=' ? "" : short_type(without_blanks(line.substr(4)));
    begin = text.data();
  }
  close(text.data());
  return parts;
}

Schema::Schema(const std::string& root, Dialect dialect, const Lookup& lookup) : dialect_(dialect) {
  root_ = resolve(short_type(root), lookup, 0);
}

std::string Schema::text() const {
  std::string text = fmt::format("ROS {}, {}\n", dialect_ == Dialect::ros1 ? 1 : 2, root_->name);
  for (const auto& [name, type] : types_) {
    text += name + "\n";
    for (const Field& field : type->fields) text += field_text(field);
  }
  return text;
}

Field Schema::parse_field(std::string_view type, std::string_view name, const std::string& package,
                          const Lookup& lookup, int depth) {
  Field field;
  field.name = name;
  parse_array(type, field);
  const std::size_t bound = type.find("<=");  // largest length of a string
  if (bound != std::string_view::npos) type = type.substr(0, bound);
  if (const auto kind = primitive(type, dialect_)) {
    field.kind = *kind;
  } else {
    const std::string full = full_name(type, package, dialect_);
    // In MCAP, a ROS 2 message may use the name Time for a type of its own package.
    if (const auto known = primitive(full, dialect_))
      field.kind = *known;
    else
      field.type = resolve(full, lookup, depth + 1);
  }
  has_wide_strings_ |= field.kind == Kind::wstring;
  return field;
}

const MessageType* Schema::resolve(const std::string& type, const Lookup& lookup, int depth) {
  if (depth > deepest_nesting)
    throw DefinitionError(fmt::format("types are nested more than {} deep", deepest_nesting));
  if (const auto known = types_.find(type); known != types_.end()) {
    if (!known->second) throw DefinitionError(fmt::format("{} contains itself", type));
    return known->second.get();
  }
  std::optional<std::string_view> text = lookup(type);
  if (!text) throw DefinitionError(fmt::format("there is no definition of {}", type));
  types_[type] = nullptr;
  auto message = std::make_unique<MessageType>();
  message->name = type;
  const std::string package = type.substr(0, type.find('/'));
  std::set<std::string_view> names;
  while (!text->empty()) {
    std::string_view line = next_line(*text);
    line = without_blanks(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const std::string_view written = line, word = next_word(line);
    const std::string_view name = line.substr(0, std::min(line.find_first_of(" \t="), line.size()));
    if (!is_identifier(name)) throw DefinitionError(fmt::format("{}: \"{}\" is not a field", type, written));
    const std::string_view rest = without_blanks(line.substr(name.size()));
    if (!rest.empty() && rest.front() == '=') continue;  // skips a constant; other text is the field's default
    if (message->fields.size() == most_fields)
      throw DefinitionError(fmt::format("{} has more than {} fields", type, most_fields));
    if (!names.insert(name).second) throw DefinitionError(fmt::format("{} has two fields \"{}\"", type, name));
    Field field = parse_field(word, name, package, lookup, depth);
    const std::uint64_t bytes = least_bytes(field);
    if (bytes == 0) continue;  // the field has no bytes in a message, so readers skip it
    message->fields.push_back(std::move(field));
    message->least_bytes = std::min(message->least_bytes + bytes, std::numeric_limits<std::uint64_t>::max() / 2);
  }
  if (dialect_ == Dialect::ros2 && message->fields.empty()) message->least_bytes = 1;
  return (types_[type] = std::move(message)).get();
}

}  // namespace modebank
