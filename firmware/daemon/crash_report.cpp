#include "firmware/daemon/crash_report.hpp"

#include <elf.h>
#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <tuple>

namespace odoless {
namespace {

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr std::size_t kLines = 32;
constexpr std::size_t kLine_bytes = 256;

/// A line that another thread may be writing while the handler reads it: of both at worst.
class SharedLine {
 public:
  void set(std::string_view text) {
    const std::size_t size = std::min(text.size(), kLine_bytes);
    for (std::size_t i = 0; i < size; ++i) {
      text_[i].store(text[i], std::memory_order_relaxed);
    }
    size_.store(size, std::memory_order_release);
  }
  [[nodiscard]] std::size_t get(std::array<char, kLine_bytes>& text) const {
    const std::size_t size = size_.load(std::memory_order_acquire);
    for (std::size_t i = 0; i < size; ++i) {
      text.at(i) = text_.at(i).load(std::memory_order_relaxed);
    }
    return size;
  }

 private:
  std::array<std::atomic<char>, kLine_bytes> text_{};
  std::atomic<std::size_t> size_{0};
};

/// All that the handler needs, made before it is needed.
struct Known {
  std::atomic<int> file{-1};
  SharedLine program;
  SharedLine build;
  SharedLine path;
  SharedLine state;
  std::array<SharedLine, kLines> log;
  std::atomic<std::size_t> logged{0};
  std::atomic<std::uintptr_t> base{0};
  std::atomic<bool> has_crashed{false};
};
Known known;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): a signal handler has no other input
static_assert(std::atomic<std::size_t>::is_always_lock_free);

void put(int file, std::string_view text) { std::ignore = ::write(file, text.data(), text.size()); }

void put(int file, const SharedLine& line) {
  std::array<char, kLine_bytes> text{};
  const std::size_t size = line.get(text);
  put(file, std::string_view(text.data(), size));
}

void put_hexadecimal(int file, std::uintptr_t number) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  constexpr int kBits = 4;
  std::array<char, 2 * sizeof(number)> text{};
  for (char& digit : text) {
    digit = kDigits.at(number >> (8 * sizeof(number) - kBits));
    number <<= kBits;
  }
  put(file, "0x");
  put(file, std::string_view(text.data(), text.size()));
}

std::string_view name_of(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "SIGSEGV";
    case SIGBUS:
      return "SIGBUS";
    case SIGFPE:
      return "SIGFPE";
    case SIGILL:
      return "SIGILL";
    default:
      return "SIGABRT";
  }
}

std::uintptr_t program_counter(const void* context) {
  const auto& machine = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
  return static_cast<std::uintptr_t>(machine.gregs[REG_RIP]);
#elif defined(__aarch64__)
  return machine.pc;
#else
  return (static_cast<void>(machine), 0);
#endif
}

void write_report(int file, int signal, const siginfo_t& info, const void* context) {
  put(file, known.program);
  put(file, known.build);
  put(file, "\ncrashed by ");
  put(file, name_of(signal));
  put(file, info.si_code > 0 ? " at address " : " that was sent; address ");
  put_hexadecimal(file, reinterpret_cast<std::uintptr_t>(info.si_code > 0 ? info.si_addr : nullptr));
  put(file, "\nin the program at ");  // for addr2line, where it is not in a library
  put_hexadecimal(file, program_counter(context) - known.base);
  put(file, "\nstate: ");
  put(file, known.state);
  put(file, "\nlast log lines:\n");
  const std::size_t logged = known.logged;
  for (std::size_t i = logged - std::min(logged, kLines); i < logged; ++i) {
    put(file, known.log.at(i % kLines));
    put(file, "\n");
  }
}

void say_briefly(int signal) {
  put(STDERR_FILENO, "odolessd: error: crashed by ");
  put(STDERR_FILENO, name_of(signal));
  put(STDERR_FILENO, known.file >= 0 ? "; a report is in " : "; there is no folder for a report (odolessd --out)");
  put(STDERR_FILENO, known.path);
  put(STDERR_FILENO, "\n");
}

// The action is the default one again by now. What the processor raised comes again when this returns; what was sent is
// sent anew, to come then.
void on_crash(int signal, siginfo_t* info, void* context) {
  if (!known.has_crashed.exchange(true)) {
    if (const int file = known.file; file >= 0) {
      write_report(file, signal, *info, context);
    }
    say_briefly(signal);
  }
  if (info->si_code <= 0) {
    std::ignore = std::raise(signal);
  }
}

/// Of the program itself, which is the first that is told.
int take_notes(dl_phdr_info* object, std::size_t /*size*/, void* /*data*/) {
  known.base = object->dlpi_addr;
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = object->dlpi_phdr[i];
    if (header.p_type != PT_NOTE) {
      continue;
    }
    for (std::size_t at = 0; at + sizeof(ElfW(Nhdr)) < header.p_memsz;) {
      // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader tells addresses as numbers
      const auto* const bytes = reinterpret_cast<const std::uint8_t*>(object->dlpi_addr + header.p_vaddr + at);
      ElfW(Nhdr) note{};
      std::memcpy(&note, bytes, sizeof(note));
      const auto padded = [](std::size_t size) { return (size + 3) / 4 * 4; };
      const std::size_t name_bytes = padded(note.n_namesz);
      if (note.n_type == NT_GNU_BUILD_ID) {
        const std::uint8_t* const id = bytes + sizeof(note) + name_bytes;
        known.build.set(fmt::format(", build {:02x}", fmt::join(id, id + note.n_descsz, "")));
      }
      at += sizeof(note) + name_bytes + padded(note.n_descsz);
    }
  }
  return 1;
}

void act(const struct sigaction& action) {
  for (const int signal : kCrashes) {
    std::ignore = ::sigaction(signal, &action, nullptr);
  }
}

}  // namespace

CrashReporter::CrashReporter(const std::filesystem::path& folder, std::string_view program) {
  if (!folder.empty()) {
    open(folder);
  }
  known.program.set(program);
  known.path.set(file_.valid() ? path_.string() : "");
  std::ignore = ::dl_iterate_phdr(take_notes, nullptr);
  known.file = file_.get();
  struct sigaction action {};
  action.sa_sigaction = on_crash;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_RESETHAND);
  act(action);
}

CrashReporter::~CrashReporter() {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  act(action);
  known.file = -1;
  if (file_.valid()) {
    std::ignore = ::unlink(path_.c_str());
  }
}

// Of two daemons with one folder, the first has the file.
void CrashReporter::open(const std::filesystem::path& folder) {
  path_ = folder / ".crash";
  const auto take = [this] {
    constexpr mode_t kMode = 0640;
    file_.reset(::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, kMode));
    if (file_.valid() && ::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
      file_.reset();
    }
  };
  take();
  struct stat status {};
  if (!file_.valid() || ::fstat(file_.get(), &status) != 0 || status.st_size == 0) {
    return;
  }
  const std::filesystem::path kept =
      folder / fmt::format("crash-{:%Y-%m-%dT%H-%M-%SZ}.txt", fmt::gmtime(status.st_mtim.tv_sec));
  std::error_code error;
  std::filesystem::rename(path_, kept, error);
  previous_ = (error ? path_ : kept).string();
  take();
}

void remember_log_line(std::string_view text) { known.log.at(known.logged.fetch_add(1) % kLines).set(text); }

void remember_state(std::string_view text) { known.state.set(text); }

}  // namespace odoless
