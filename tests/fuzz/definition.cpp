// Reads definitions of ROS messages.
#include "io/recording/message_columns.hpp"
#include "io/recording/topic_decoder.hpp"
#include "tests/fuzz/entry.hpp"

namespace modebank::fuzz {

namespace {

/// Reads a definition of p/T, as it is in .msg files and recordings, in both dialects. Then reads a message of zeros.
void read_definition(std::string_view text) {
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const auto parts = split_definitions("p/T", text);
    try {
      const Schema schema("p/T", dialect, [&](const std::string& type) -> std::optional<std::string_view> {
        const auto found = parts.find(type);
        return found == parts.end() ? std::nullopt : std::optional(found->second);
      });
      columns_of(schema, std::string(200, '\0'), 4);
    } catch (const DefinitionError&) {  // callers report either exception as the reason why a topic cannot be read
    } catch (const PayloadError&) {
    }
  }
  std::string problem;
  KnownDefinitions(scratch_file("T.msg", text).parent_path()).candidates("p/T", problem);
}

const Entry definition("definition", read_definition);

}  // namespace

}  // namespace modebank::fuzz
