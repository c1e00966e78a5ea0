#include "app/report/figures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "app/report/page/assets.hpp"
#include "io/files/memory_file.hpp"
#include "io/files/output_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
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

/// A folder inside the one that figures go to, so that finished files only have to be renamed; gone at the end; what a
/// killed process left is removed after a day by the next one that draws there.
class WorkFolder {
 public:
  explicit WorkFolder(const fs::path& parent) : path_(temporary_path(fs::absolute(parent) / "figures")) {
    remove_leftovers(parent);
    constexpr mode_t mine_alone = 0700;
    if (::mkdir(path_.c_str(), mine_alone) != 0) fail(parent, {errno, std::generic_category()});
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

/// One figure that gnuplot cannot draw.
struct FigureFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws FigureFailure when gnuplot fails on this figure.
std::string draw(const Figure& figure, const fs::path& folder, const char* format) {
  const MemoryFile drawn, messages;
  const int status = run_gnuplot(folder, figure.name(), format, drawn, messages);
  if (status == 127)
    throw ConfigurationError("report.figures needs gnuplot, which is not installed (Debian package gnuplot-nox)");
  std::string content = drawn.content();
  if (status != 0 || content.empty())
    throw FigureFailure(fmt::format("{}.{}: gnuplot could not draw it: {}", figure.name(), format,
                                    messages.content().empty() ? "it gives no reason" : messages.content()));
  return content;
}

const char* const style_file = "style.gp";
const char* const strip_file = "strip.gp";

std::vector<std::string> formats_of(const FigureOptions& options) {
  std::vector<std::string> formats{"svg", "pdf"};
  if (options.png) formats.emplace_back("png");
  return formats;
}

/// The endings of a figure's files.
std::vector<std::string> endings_of(const FigureOptions& options) {
  std::vector<std::string> endings = formats_of(options);
  endings.emplace_back("tex");
  if (options.sources) endings.insert(endings.end(), {"gp", "dat"});
  return endings;
}

/// Form of a figure's files with one ending: those with a sign of their own, or beside a file with its.
FileForm figure_form(const Figure& figure, const std::string& ending) {
  const bool source = ending == "gp" || ending == "dat";
  const std::string sign = source ? figure.script_sign() : figure.latex_sign();
  const FileForm bearer = form_by_front("a figure of a report", sign, sign.size());
  return {bearer.name, [bearer, name = figure.name() + (source ? ".gp" : ".tex")](const fs::path& path) {
            const fs::path shown = path.parent_path() / name;
            return fs::is_regular_file(shown) && bearer.is_one(shown);
          }};
}

/// Files on their way into the folder.
class FigureFolder {
 public:
  explicit FigureFolder(const fs::path& folder) : folder_(folder), work_(folder) {}

  const fs::path& work() const { return work_.path(); }
  void stage(const std::string& name, std::string_view text) const {
    write_staged(work_.path() / name, folder_ / name, text);
  }
  /// Renames what was staged under these names.
  void finish(const std::vector<std::string>& names) const {
    std::error_code error;
    for (const std::string& name : names) {
      fs::rename(work_.path() / name, folder_ / name, error);
      if (error) fail(folder_ / name, error);
    }
  }

 private:
  fs::path folder_;
  WorkFolder work_;
};

/// Stages everything of a figure; returns the files' names.
std::vector<std::string> stage_figure(const Figure& figure, const FigureFolder& folder, const FigureOptions& options) {
  std::vector<std::string> files;
  folder.stage(figure.name() + ".gp", figure.script());
  folder.stage(figure.name() + ".dat", figure.data());
  for (const std::string& format : formats_of(options))
    folder.stage(figure.name() + "." + format, draw(figure, folder.work(), format.c_str()));
  folder.stage(figure.name() + ".tex", figure.latex());
  for (const std::string& ending : endings_of(options)) files.push_back(figure.name() + "." + ending);
  return files;
}

/// What is wrong with the disk concerns every figure, what is wrong with a figure that one alone.
DrawnFigures draw_into(const FigureFolder& folder, const std::vector<Figure>& figures, const FigureOptions& options) {
  DrawnFigures drawn;
  folder.stage(style_file, assets::figure_style());
  folder.stage(strip_file, assets::figure_strip());
  for (const Figure& figure : figures) {
    std::vector<std::string> files;
    try {
      files = stage_figure(figure, folder, options);
    } catch (const FigureFailure& failure) {
      drawn.failed.emplace_back(failure.what());
      continue;
    }
    folder.finish(files);
    drawn.files.insert(drawn.files.end(), files.begin(), files.end());
  }
  if (options.sources && !drawn.files.empty()) {
    folder.finish({style_file, strip_file});
    drawn.files.insert(drawn.files.end(), {style_file, strip_file});
  }
  return drawn;
}

/// A file is checked as what a user names, where there is one: the folder may have yet to be made.
void check_file(const FigureOptions& options, const std::string& name, const FileForm& form,
                const std::vector<fs::path>& sources) {
  const fs::path path = options.folder / name;
  if (fs::exists(path)) check_output({"report.figures", path, form}, sources);
}

}  // namespace

void check_figure_files(const std::vector<Figure>& figures, const FigureOptions& options,
                        const std::vector<fs::path>& sources) {
  for (const Figure& figure : figures)
    for (const std::string& ending : endings_of(options))
      check_file(options, figure.name() + "." + ending, figure_form(figure, ending), sources);
  if (!options.sources) return;
  for (const auto& [name, content] : {std::pair<const char*, std::string_view>{style_file, assets::figure_style()},
                                      {strip_file, assets::figure_strip()}}) {
    const std::string first(content.substr(0, content.find('\n')));
    check_file(options, name, form_by_front("a script of figures", first, first.size()), sources);
  }
}

DrawnFigures draw_figures(const std::vector<Figure>& figures, const FigureOptions& options) {
  std::error_code error;
  const bool made = fs::create_directories(options.folder, error);
  if (error) fail(options.folder, error);
  try {
    return draw_into(FigureFolder(options.folder), figures, options);
  } catch (...) {
    if (made) fs::remove(options.folder, error);  // if nothing is in it
    throw;
  }
}

}  // namespace modebank::app::report
