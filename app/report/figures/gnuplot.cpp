#include "app/report/figures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>

#include "app/report/page/assets.hpp"
#include "io/files/memory_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

// NOLINTNEXTLINE(readability-redundant-declaration): POSIX leaves its declaration to the user, glibc gives one.
extern char** environ;

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, const std::error_code& error) {
  const std::string what = fmt::format("report.figures: cannot write to {}: {}", folder.string(), error.message());
  if (is_disk_failure(error)) throw DataError(what);
  throw ConfigurationError(what);
}

/// A folder inside the one that figures go to, so that finished files only have to be renamed; gone at the end.
class WorkFolder {
 public:
  explicit WorkFolder(const fs::path& parent) {
    std::string pattern = (fs::absolute(parent) / ".figures-XXXXXX").string();
    if (!mkdtemp(pattern.data())) fail(parent, {errno, std::generic_category()});
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

/// Spawns gnuplot in `folder` on NAME.gp; figure and messages go to memory: it does not say when a disk is full.
int run_gnuplot(const fs::path& folder, const std::string& name, const char* format, const MemoryFile& drawn,
                const MemoryFile& messages) {
  const std::string script = name + ".gp";
  const std::string setting = fmt::format("format = '{}'; drawn = '/dev/stdout'", format);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, drawn.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages.descriptor(), STDERR_FILENO);
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

std::string draw(const Figure& figure, const fs::path& folder, const char* format) {
  const MemoryFile drawn, messages;
  const int status = run_gnuplot(folder, figure.name(), format, drawn, messages);
  if (status == 127)
    throw ConfigurationError("report.figures needs gnuplot, which is not installed (Debian package gnuplot-nox)");
  std::string content = drawn.content();
  if (status != 0 || content.empty())
    throw DataError(fmt::format("gnuplot could not draw {}: {}", figure.name(),
                                messages.content().empty() ? "it gives no reason" : messages.content()));
  return content;
}

}  // namespace

std::vector<std::string> draw_figures(const std::vector<Figure>& figures, const FigureOptions& options) {
  std::error_code error;
  const bool made = fs::create_directories(options.folder, error);
  if (error) fail(options.folder, error);
  std::vector<std::string> files;
  try {
    const WorkFolder work(options.folder);
    const auto write = [&](const std::string& name, std::string_view text) {
      write_staged(work.path() / name, options.folder / name, text);
    };
    write("style.gp", assets::figure_style());
    write("strip.gp", assets::figure_strip());
    if (options.sources) files = {"style.gp", "strip.gp"};
    for (const Figure& figure : figures) {
      write(figure.name() + ".gp", figure.script());
      write(figure.name() + ".dat", figure.data());
      for (const char* format : {"svg", "png"}) {
        if (format == std::string_view("png") && !options.png) continue;
        files.push_back(figure.name() + "." + format);
        write(files.back(), draw(figure, work.path(), format));
      }
      if (options.sources) files.insert(files.end(), {figure.name() + ".gp", figure.name() + ".dat"});
    }
    for (const std::string& file : files) {
      fs::rename(work.path() / file, options.folder / file, error);
      if (error) fail(options.folder / file, error);
    }
  } catch (...) {
    if (made) fs::remove(options.folder, error);
    throw;
  }
  return files;
}

}  // namespace modebank::app::report
