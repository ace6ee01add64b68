#include "tests/support/process/process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace voxtouch::test {
namespace {

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::filesystem::path make_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "voxtouch_test_XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw std::runtime_error("no temporary folder could be made");
  return name;
}

/// The first domain from 61 to 85 whose name no other test holds. It is held, as a socket of that
/// name, until this process and all its children have ended. Nodes of a killed ring take a moment
/// to end, and the next test would find them there. Above 100 the ports of a domain (7400 + 250 of
/// them each) are in the kernel's range of ephemeral ports.
int claim_domain() {
  constexpr int kFirst = 61, kCount = 25;  // from 86 on the domains belong to tests in Python
  for (int n = 0; n < kCount; ++n) {
    const int domain = kFirst + (static_cast<int>(getpid()) + n) % kCount;
    const std::string name = "voxtouch test domain " + std::to_string(domain);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1,
              sizeof address.sun_path - 1);  // the zero before it: a name without a file
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    const int bound = socket(AF_UNIX, SOCK_DGRAM, 0);
    if (bound >= 0 && bind(bound, reinterpret_cast<const sockaddr*>(&address), size) == 0)
      return domain;
    if (bound >= 0)
      close(bound);
  }
  throw std::runtime_error("every DDS domain from 61 to 85 is held by another test");
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments,
                 const std::map<std::string, std::string>& environment)
    : folder_(make_folder()) {
  std::vector<std::string> variables;
  for (char** e = environ; *e; ++e)
    variables.emplace_back(*e);
  for (const auto& [name, value] : environment)
    variables.push_back(name + "=" + value);
  std::vector<char*> argv, env;
  std::vector<std::string> texts = arguments;
  for (std::string& t : texts)
    argv.push_back(t.data());
  for (std::string& v : variables)
    env.push_back(v.data());
  argv.push_back(nullptr), env.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, (folder_ / "out").c_str(), O_WRONLY | O_CREAT,
                                   0600);
  posix_spawn_file_actions_addopen(&actions, 2, (folder_ / "err").c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0600);
  const int error = posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), env.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error)
    throw std::runtime_error(arguments[0] + " could not be started");
}

Process::~Process() {
  if (running()) {
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  std::filesystem::remove_all(folder_);
}

void Process::signal(int number) const {
  if (!status_)
    ::kill(pid_, number);
}

bool Process::running() {
  int raw = 0;
  if (!status_ && waitpid(pid_, &raw, WNOHANG) == pid_)
    status_ = WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
  return !status_;
}

Finished Process::wait(std::chrono::seconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (running() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (running()) {
    ::kill(pid_, SIGKILL);
    while (running())
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {*status_, read_all(folder_ / "out"), read_all(folder_ / "err")};
}

std::string Process::err() const { return read_all(folder_ / "err"); }

TemporaryFolder::TemporaryFolder() : path_(make_folder()) {}
TemporaryFolder::~TemporaryFolder() { std::filesystem::remove_all(path_); }

std::string fresh_domain() {
  static const std::string domain = std::to_string(claim_domain());
  return domain;
}

bool has_ended(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(in, text);
  const std::size_t after = text.rfind(')');
  return after == std::string::npos || text.compare(after, 4, ") Z ") == 0;
}

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos)
      continue;
    std::ifstream in(entry.path() / "stat");
    std::string text;
    std::getline(in, text);
    const std::size_t after = text.rfind(')');
    if (after == std::string::npos)
      continue;
    std::istringstream rest(text.substr(after + 2));
    char state = 0;
    pid_t owner = 0;
    rest >> state >> owner;
    if (owner == parent && state != 'Z')
      children.push_back(std::stoi(name));
  }
  return children;
}

pid_t child_called(pid_t parent, const std::string& program) {
  for (const pid_t child : children_of(parent)) {
    std::ifstream command("/proc/" + std::to_string(child) + "/cmdline");
    std::string name;
    std::getline(command, name, '\0');
    if (name.ends_with(program))
      return child;
  }
  return 0;
}

}  // namespace voxtouch::test
