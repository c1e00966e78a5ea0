#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace modebank::app::view {

/// An archive in a line of the overview, read from its small parts alone; its hash is not checked:
///   kind           run or study
///   created        UTC, ISO 8601
///   data           what was read: the file's name, or its folder's and how many
///   answer, text   the verdict in a word and in its sentence; absent without one, as all below
///   modes, gain, standard_error [nats/sample]
///   samples, log_score [nats/sample], coverage_95   of the bank on held-out runs
/// Throws as read_archive does.
nlohmann::json digest_of(const std::filesystem::path& archive);

/// What a child has written of it, though an archive may have made the child write anything: the members above and no
/// others, of their types, texts cut. Throws DataError for what is no digest.
nlohmann::json checked_digest(const std::string& text);

}  // namespace modebank::app::view
