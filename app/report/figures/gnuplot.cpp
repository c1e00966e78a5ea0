#include "app/report/figures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "app/report/page/assets.hpp"
#include "modebank/base/error.hpp"

// NOLINTNEXTLINE(readability-redundant-declaration): POSIX leaves its declaration to the user, glibc gives one.
extern char** environ;

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;

/// A folder inside the one that figures go to, so that finished files only have to be renamed; gone at the end.
class WorkFolder {
 public:
  explicit WorkFolder(const fs::path& parent) {
    std::string pattern = (fs::absolute(parent) / ".figures-XXXXXX").string();
    if (!mkdtemp(pattern.data()))
      throw ConfigurationError(fmt::format("report.figures: cannot write to {}: {}", parent.string(), strerror(errno)));
    path_ = pattern;
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void write_text(const fs::path& path, std::string_view text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw DataError(fmt::format("{}: cannot write", path.string()));
}

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Spawns gnuplot in `folder` on NAME.gp; its messages go to a file there.
int run_gnuplot(const fs::path& folder, const std::string& name, const char* format) {
  const std::string messages = (folder / "messages").string(), script = name + ".gp";
  const std::string setting = fmt::format("format = '{}'", format);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  // -d: no start-up file of the user's may change the figures.
  std::vector<std::string> words{"gnuplot", "-d", "-e", setting, script};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed == ENOENT)
    throw ConfigurationError("report.figures needs gnuplot, which is not installed (Debian package gnuplot-nox)");
  if (failed != 0) throw DataError(fmt::format("gnuplot cannot be started: {}", strerror(failed)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void draw(const Figure& figure, const fs::path& folder, const char* format) {
  const int status = run_gnuplot(folder, figure.name(), format);
  if (status == 127)
    throw ConfigurationError("report.figures needs gnuplot, which is not installed (Debian package gnuplot-nox)");
  const fs::path drawn = folder / (figure.name() + "." + format);
  std::error_code ignored;
  if (status != 0 || !fs::exists(drawn) || fs::file_size(drawn, ignored) == 0) {
    const std::string messages = read_text(folder / "messages");
    throw DataError(fmt::format("gnuplot could not draw {}: {}", figure.name(),
                                messages.empty() ? "it gives no reason; the disk may be full" : messages));
  }
}

}  // namespace

std::vector<std::string> draw_figures(const std::vector<Figure>& figures, const FigureOptions& options) {
  std::error_code error;
  const bool made = fs::create_directories(options.folder, error);
  if (error) throw ConfigurationError(fmt::format("report.figures = {}: {}", options.folder.string(), error.message()));
  std::vector<std::string> files;
  try {
    const WorkFolder work(options.folder);
    write_text(work.path() / "style.gp", assets::figure_style());
    write_text(work.path() / "strip.gp", assets::figure_strip());
    if (options.sources) files = {"style.gp", "strip.gp"};
    for (const Figure& figure : figures) {
      write_text(work.path() / (figure.name() + ".gp"), figure.script());
      write_text(work.path() / (figure.name() + ".dat"), figure.data());
      draw(figure, work.path(), "svg");
      files.push_back(figure.name() + ".svg");
      if (options.png) draw(figure, work.path(), "png"), files.push_back(figure.name() + ".png");
      if (options.sources) files.insert(files.end(), {figure.name() + ".gp", figure.name() + ".dat"});
    }
    for (const std::string& file : files) fs::rename(work.path() / file, options.folder / file);
  } catch (...) {
    if (made) fs::remove(options.folder, error);
    throw;
  }
  return files;
}

}  // namespace modebank::app::report
