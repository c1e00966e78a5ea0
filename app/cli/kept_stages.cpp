#include "app/cli/kept_stages.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <exception>

#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array signals{SIGINT, SIGTERM};

/// Message of the signal handler. It is prepared in advance, because a signal handler must not allocate memory.
std::array<char, 4096> kept_message;
std::atomic<std::size_t> kept_size = 0;

extern "C" void say_what_is_kept(int signal) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kept_message.data(), kept_size);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void set_message(const std::string& text) {
  kept_size = 0;
  const std::size_t size = std::min(text.size(), kept_message.size());
  std::memcpy(kept_message.data(), text.data(), size);
  kept_size = size;
}

void tell_kept(const fs::path& folder) {
  set_message(fmt::format(
      "\nmodebank: stopped; finished stages that took long are kept in {}. The same command continues from there\n",
      printable(folder.string())));
}

}  // namespace

KeptStages::KeptStages(const fs::path& output)
    : folder_(output.parent_path() / fmt::format(".{}.stages", output.filename().string())),
      store_(folder_, {.kept = [this] { tell_kept(folder_); }}) {
  set_message("\nmodebank: stopped; no stage that took long was finished, so nothing is kept\n");
  for (std::size_t i = 0; i < signals.size(); ++i) {
    before_[i] = std::signal(signals[i], say_what_is_kept);
    if (before_[i] == SIG_IGN)
      std::signal(signals[i],
                  SIG_IGN);  // ignored signals stay ignored, as under nohup or in background jobs
  }
  if (folder_is_link())
    spdlog::warn("{} is a symbolic link, so no stage is kept there; remove the link", folder_.string());
}

void KeptStages::provide(Stage stage, const std::string& key, const StagePart& part) {
  if (folder_is_link()) return part.compute();
  store_.provide(stage, key, part);
}

bool KeptStages::folder_is_link() const {
  std::error_code error;
  return fs::is_symlink(fs::symlink_status(folder_, error));
}

KeptStages::~KeptStages() {
  for (std::size_t i = 0; i < signals.size(); ++i) std::signal(signals[i], before_[i]);
  std::error_code error;
  if (folder_is_link()) return;
  if (std::uncaught_exceptions() == 0)
    store_.clear();
  else if (fs::exists(folder_, error))
    spdlog::warn("finished stages that took long are kept in {}; the same command continues from there",
                 folder_.string());
}

}  // namespace modebank::app
