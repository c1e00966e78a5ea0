#include "tests/app/study/study_fixture.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "io/archive/inspect.hpp"

namespace modebank::test {

StudyTest::StudyTest() {
  write("study.ini", std::string(config_text()) +
                         "[bank]\n"
                         "transition = stay\n"
                         "[study]\n"
                         "vary = window.length = 10 | 20\n"
                         "vary = mixture.components = {1..3}\n"
                         "vary = bank.stay = 0.9 | 0.95\n"
                         "vary = filter.variant = imm | salvi2025\n");
}

std::vector<std::string> StudyTest::study_line(const std::string& folder,
                                               const std::vector<std::string>& options) const {
  std::vector<std::string> line{MODEBANK_PROGRAM,  "study",          file("study.ini").string(), "--data.root",
                                file("").string(), "--study.output", file(folder).string()};
  line.insert(line.end(), options.begin(), options.end());
  return line;
}

ProgramResult StudyTest::study(const std::string& folder, const std::vector<std::string>& options) const {
  return run_program(study_line(folder, options));
}

std::string StudyTest::numbers(const std::string& folder) const {
  const std::filesystem::path path = file(folder) / "study.h5";
  return inspect(path, "/study").dump() + inspect(path, "/answers/main_effects").dump() +
         inspect(path, "/answers/best").dump();
}

std::vector<std::filesystem::path> StudyTest::archives(const std::string& folder) const {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(file(folder) / "trials"))
    if (entry.path().extension() == ".h5") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool StudyTest::kill_a_worker(const std::string& folder, std::mt19937_64& generator) const {
  std::vector<std::filesystem::path> claims;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(file(folder) / "trials", absent))
    if (entry.path().extension() == ".claim") claims.push_back(entry.path());
  std::shuffle(claims.begin(), claims.end(), generator);
  for (const auto& claim : claims) {
    std::ifstream stream(claim);
    const auto holder = nlohmann::json::parse(stream, nullptr, false);  // the claim may end while the file is read
    if (holder.is_object() && kill(holder.at("process").get<pid_t>(), SIGKILL) == 0) return true;
  }
  return false;
}

void StudyTest::run_undisturbed() const {
  const ProgramResult result = study(undisturbed);
  ASSERT_EQ(result.status, 0) << result.err;
  ASSERT_EQ(archives(undisturbed).size(), trials);
}

Process::Process(const std::vector<std::string>& arguments) : child_(fork()) {
  if (child_ < 0) throw std::runtime_error("fork failed");
  if (child_ > 0) {
    setpgid(child_, child_);  // the child does this as well, because either process may be first
    return;
  }
  setpgid(0, 0);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  execv(argv[0], argv.data());
  _exit(127);
}

Process::~Process() {
  kill_with_children();
  if (!ended_) waitpid(child_, nullptr, 0);
}

void Process::kill_alone() const {
  if (!ended_) kill(child_, SIGKILL);
}

void Process::kill_with_children() const { killpg(child_, SIGKILL); }

int Process::wait() {
  int status = 0;
  if (waitpid(child_, &status, 0) < 0) throw std::runtime_error("waitpid failed");
  ended_ = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace modebank::test
