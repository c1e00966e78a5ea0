#include "io/files/output_file.hpp"

#include <utility>

#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

namespace fs = std::filesystem;

/// The first bytes of a file, at most `bytes`.
std::string front_of(const fs::path& path, std::size_t bytes) {
  std::ifstream stream = open_file(path);
  std::string front(bytes, '\0');
  stream.read(front.data(), static_cast<std::streamsize>(bytes));
  front.resize(static_cast<std::size_t>(stream.gcount()));
  return front;
}

/// Reason why the path cannot be written. Empty if it can be written. Symbolic links that form a loop are such a
/// reason.
std::string obstacle_at(const fs::path& path) {
  fs::path target;
  try {
    target = final_target(path);
  } catch (const DataError& error) {
    return error.what();
  }
  return write_obstacle(target);
}

}  // namespace

FileForm form_by_front(std::string name, std::string sign, std::size_t within) {
  return {std::move(name), [sign = std::move(sign), within](const fs::path& path) {
            return front_of(path, within).find(sign) != std::string::npos;
          }};
}

void check_output(const OutputFile& output, const std::vector<fs::path>& sources) {
  const auto refuse = [&](const std::string& why) {
    throw ConfigurationError(output.option + ": " + why + "; name another file");
  };
  const std::string path = output.path.string();
  if (const std::string obstacle = obstacle_at(output.path); !obstacle.empty())
    refuse("cannot write " + path + ": " + obstacle);
  std::error_code error;
  for (const fs::path& source : sources)
    if (fs::equivalent(source, output.path, error)) refuse(path + " is read by this command");
  if (fs::file_size(output.path, error) == 0 || error) return;  // an empty file may be replaced
  if (!output.form.is_one(output.path))
    refuse(path + " exists and is not replaced, because it is not " + output.form.name);
}

}  // namespace modebank
