#include "firmware/daemon/signals.hpp"

#include <sys/signalfd.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <string_view>

#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr std::array<int, 14> kSignals{SIGTERM, SIGINT,    SIGHUP,  SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM,
                                       SIGIO,   SIGVTALRM, SIGPROF, SIGXCPU, SIGXFSZ, SIGPWR,  SIGSTKFLT};

sigset_t blocked_set() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kSignals) {
    sigaddset(&set, signal);
  }
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) {
    sigaddset(&set, signal);
  }
  return set;
}

std::string signal_name(int signal) {
  const char* const name = sigabbrev_np(signal);
  return name != nullptr ? name : std::to_string(signal);
}

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): a signal handler has no other input
std::atomic<int> status_in_the_end{0};
std::atomic<std::int64_t> end_ns{0};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

// Somebody else may send SIGALRM, too.
void end_if_it_is_time(int /*signal*/) {
  if (monotonic_ns() < end_ns) {
    return;
  }
  constexpr std::string_view kLast = "odolessd: error: the shutdown takes too long\n";
  static_cast<void>(!::write(STDERR_FILENO, kLast.data(), kLast.size()));
  ::_exit(status_in_the_end);
}

}  // namespace

void block_signals() {
  const sigset_t set = blocked_set();
  static_cast<void>(pthread_sigmask(SIG_BLOCK, &set, nullptr));
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // a line whose other side is gone says so by itself
}

SignalReader::SignalReader() {
  const sigset_t set = blocked_set();
  descriptor_.reset(::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
}

SignalMeaning SignalReader::next() {
  signalfd_siginfo info{};
  while (::read(descriptor_.get(), &info, sizeof(info)) == static_cast<ssize_t>(sizeof(info))) {
    if (info.ssi_signo == SIGXFSZ && info.ssi_pid == static_cast<std::uint32_t>(::getpid())) {
      continue;
    }
    name_ = signal_name(static_cast<int>(info.ssi_signo));
    return info.ssi_signo == SIGHUP ? SignalMeaning::kReload : SignalMeaning::kEnd;
  }
  return SignalMeaning::kNone;
}

void end_process_after(unsigned seconds, int status) {
  status_in_the_end = status;
  end_ns = monotonic_ns() + std::int64_t{seconds} * 1'000'000'000;
  struct sigaction action {};
  action.sa_handler = end_if_it_is_time;
  action.sa_flags = SA_RESTART;
  static_cast<void>(::sigaction(SIGALRM, &action, nullptr));
  sigset_t alarm_alone;
  sigemptyset(&alarm_alone);
  sigaddset(&alarm_alone, SIGALRM);
  static_cast<void>(pthread_sigmask(SIG_UNBLOCK, &alarm_alone, nullptr));
  const itimerval once{.it_interval = {.tv_sec = 0, .tv_usec = 0},
                       .it_value = {.tv_sec = static_cast<time_t>(seconds), .tv_usec = 1000}};
  static_cast<void>(::setitimer(ITIMER_REAL, &once, nullptr));
}

void let_process_end_in_its_time() {
  const itimerval never{};
  static_cast<void>(::setitimer(ITIMER_REAL, &never, nullptr));
}

}  // namespace odoless
