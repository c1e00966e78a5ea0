#include "io/recording/topic_decoder.hpp"

#include <fmt/format.h>

namespace modebank {

namespace {

using Schemas = std::vector<std::shared_ptr<const Schema>>;

/// Adds the definition that the recording contains.
void add_embedded(const Connection& connection, Schemas& candidates, std::string& problem) {
  const bool ros1 = connection.encoding == Connection::Encoding::ros1;
  if (connection.definition.empty()) return;
  if (connection.definition_form != (ros1 ? "ros1msg" : "ros2msg")) {
    problem = fmt::format("its definition has the format \"{}\", which is not supported", connection.definition_form);
    return;
  }
  const std::string root = short_type(connection.type);
  const auto parts = split_definitions(root, connection.definition);
  const auto lookup = [&](const std::string& type) -> std::optional<std::string_view> {
    if (const auto found = parts.find(type); found != parts.end()) return found->second;
    // Some writers omit the package in the type's name, or write a wrong package.
    const std::string ending = type.substr(type.find('/') + 1);
    for (const auto& [name, text] : parts)
      if (name.substr(name.find('/') + 1) == ending) return text;
    return {};
  };
  try {
    candidates.push_back(std::make_shared<Schema>(root, ros1 ? Dialect::ros1 : Dialect::ros2, lookup));
  } catch (const DefinitionError& error) {
    problem = fmt::format("its definition: {}", error.what());
  }
}

/// The columns that this definition gives for the samples. If the definition does not fit, returns nullopt and sets the
/// reason.
std::optional<std::vector<MessageColumn>> try_schema(const Schema& schema, unsigned wide_bytes,
                                                     const std::vector<std::string>& samples, std::string& problem) {
  try {
    std::vector<MessageColumn> columns;
    for (const std::string& sample : samples) merge_columns(columns, columns_of(schema, sample, wide_bytes));
    return columns;
  } catch (const PayloadError& error) {
    if (problem.empty())
      problem = fmt::format("the definition of {} does not fit a message: {}", schema.root().name, error.what());
    return {};
  }
}

}  // namespace

TopicDecoder choose_decoder(const Connection& connection, const KnownDefinitions& known,
                            const std::vector<std::string>& samples) {
  TopicDecoder decoder;
  if (connection.encoding == Connection::Encoding::unknown) {
    decoder.problem =
        fmt::format("its messages have the format \"{}\", which is not supported", connection.encoding_name);
    if (connection.encoding_name == "protobuf")
      decoder.problem += "; read them in Python with mcap-protobuf-support and pass them to modebank.run as a frame";
    return decoder;
  }
  std::string problem;
  Schemas candidates;
  add_embedded(connection, candidates, problem);
  if (connection.encoding == Connection::Encoding::cdr)
    for (auto& candidate : known.candidates(connection.type, problem)) candidates.push_back(std::move(candidate));
  for (const auto& schema : candidates)
    for (const unsigned wide_bytes : {4u, 2u}) {
      if (wide_bytes == 2 && !schema->has_wide_strings()) continue;
      if (auto columns = try_schema(*schema, wide_bytes, samples, problem))
        return {schema, wide_bytes, std::move(*columns), {}};
    }
  decoder.problem = problem.empty() ? "there is no definition of its type" : problem;
  return decoder;
}

}  // namespace modebank
