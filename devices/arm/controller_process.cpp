#include "devices/arm/controller_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include "core/types/program_folder.hpp"
#include "devices/driver.hpp"

namespace voxtouch::arm {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kStart = 10s;  // on a very busy machine
constexpr auto kStopTimeout = 2s;
constexpr std::string_view kReady = "simulated controller:";  // prefix of its first line
constexpr int kExecFailed = 127;

std::string words(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("ended by signal {}", WTERMSIG(status));
  return fmt::format("ended with status {}", WEXITSTATUS(status));
}

/// Between fork and exec of a process with threads: async-signal-safe calls only.
[[noreturn]] void become(char* const* argv, pid_t parent, int hand, int log) {
  // It must not continue to send to a port without an owner, or of another program.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent)
    _exit(kExecFailed);
  setpgid(0, 0);  // SIGINT goes to the parent, which stops the arm and then ends this process
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, 0), dup2(nothing, 1), dup2(log, 2);
  close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);  // including the network's sockets
  fcntl(hand, F_SETFD, 0);
  execv(argv[0], argv);
  _exit(kExecFailed);
}

}  // namespace

ControllerProcess::File::File(const char* name, std::string_view device)
    : number(memfd_create(name, MFD_CLOEXEC)) {
  if (number < 0)
    throw devices::DeviceOpenError(
        fmt::format("device '{}': cannot create a memory file ({})", device, std::strerror(errno)));
}

ControllerProcess::File::~File() { close(number); }

ControllerProcess::ControllerProcess(std::string_view device, const std::string& name,
                                     const std::vector<std::string>& arguments,
                                     const std::string& hand)
    : device_(device),
      hand_("voxtouch_hand", device),
      log_("voxtouch_controller_log", device) {
  if (pwrite(hand_.number, hand.data(), hand.size(), 0) != static_cast<ssize_t>(hand.size()))
    refuse(fmt::format(": cannot write the hand ({})", std::strerror(errno)));
  const std::string program = (program_folder() / name).string();
  if (access(program.c_str(), X_OK) != 0)
    refuse(
        fmt::format(": cannot run the simulated controller {} ({}). Build the target {} and keep "
                    "it in this program's folder",
                    program, std::strerror(errno), name));
  start(program, arguments);
  try {
    wait_until_ready();
  } catch (...) {
    end();
    throw;
  }
}

void ControllerProcess::refuse(const std::string& why) const {
  throw devices::DeviceOpenError(fmt::format("device '{}'{}", device_, why));
}

void ControllerProcess::start(const std::string& program,
                              const std::vector<std::string>& arguments) {
  std::vector<std::string> texts = {program};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  texts.insert(texts.end(), {"--hand", fmt::format("/proc/self/fd/{}", hand_.number)});
  std::vector<char*> argv;
  for (std::string& text : texts)
    argv.push_back(text.data());
  argv.push_back(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0)
    become(argv.data(), parent, hand_.number, log_.number);
  if (pid_ < 0)
    refuse(fmt::format(": cannot start {} ({})", program, std::strerror(errno)));
}

void ControllerProcess::wait_until_ready() {
  for (const auto give_up = Clock::now() + kStart; said().find(kReady) == std::string::npos;) {
    const std::string how = ending();
    if (!how.empty())
      refuse(fmt::format(" cannot be opened: its simulated controller {}: {}", how, said()));
    if (Clock::now() > give_up)
      refuse(
          " cannot be opened: its simulated controller was not ready in time; check the machine's "
          "load");
    std::this_thread::sleep_for(2ms);
  }
}

ControllerProcess::~ControllerProcess() { end(); }

void ControllerProcess::end() noexcept {
  const std::lock_guard lock(mutex_);
  if (running())
    kill(pid_, SIGTERM);
  for (const auto give_up = Clock::now() + kStopTimeout; running() && Clock::now() < give_up;)
    std::this_thread::sleep_for(2ms);
  if (!running())
    return;
  kill(pid_, SIGKILL);
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR)
    continue;
  status_ = status;
}

bool ControllerProcess::running() const {
  int status = 0;
  if (!status_ && waitpid(pid_, &status, WNOHANG) == pid_)
    status_ = status;
  return !status_;
}

std::string ControllerProcess::ending() const {
  const std::lock_guard lock(mutex_);
  return running() ? std::string() : words(*status_);
}

std::string ControllerProcess::said() const {
  std::array<char, 4096> text;
  const off_t size = lseek(log_.number, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t got = pread(log_.number, text.data(), text.size(), from);
  std::string words(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  while (!words.empty() && words.back() == '\n')
    words.pop_back();
  for (char& c : words)
    if (c == '\n')
      c = ' ';
  return words;
}

}  // namespace voxtouch::arm
