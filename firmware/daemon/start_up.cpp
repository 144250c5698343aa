#include "firmware/daemon/start_up.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sysexits.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "drivers/io/file_descriptor.hpp"
#include "rt/memory_lock.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {
namespace {

// Wake-ups, signals, commands and who sends them, laser, servo, GPIO lines, LCM, recorder, poses, and files to save.
constexpr int kDescriptors = 48;

// Of a cell in the map as it is saved, its picture and the files made of both; and for all else that is not there from
// the start on: log lines, messages, a configuration that is read anew.
constexpr std::size_t kSaved_bytes_per_cell = 12;
constexpr std::size_t kOther_bytes = std::size_t{8} << 20;

constexpr double kMbPerByte = 1e-6;

// -1: there is no limit.
double limit_mb(__rlimit_resource resource) {
  rlimit limit{};
  const bool is_limited = ::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return is_limited ? static_cast<double>(limit.rlim_cur) * kMbPerByte : -1.0;
}

// Why no file can be made there; 0: one can.
int folder_error(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / fmt::format(".odolessd-{}", ::getpid());
  const FileDescriptor made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  const int error = made.valid() ? 0 : errno;
  if (made.valid()) {
    static_cast<void>(::unlink(file.c_str()));
  }
  return error;
}

Lack lack_of_folder(const std::filesystem::path& folder, const char* origin) {
  const int error = folder_error(folder.empty() ? "." : folder);
  return error == 0 ? Lack{}
                    : Lack{EX_CANTCREAT, fmt::format("{}: no file can be made there: {} ({}); a folder is needed that "
                                                     "is there and that this user may write to",
                                                     folder.string(), reason_of(error), origin)};
}

}  // namespace

std::string reason_of(int error) { return std::strerror(error); }  // NOLINT(concurrency-mt-unsafe): one thread

void hold_standard_descriptors() {
  for (int descriptor = 0; descriptor <= 2;) {
    descriptor = ::open("/dev/null", O_RDWR);  // NOLINT(android-cloexec-open): as those that a shell opens
    if (descriptor < 0) {
      return;
    }
    if (descriptor > 2) {
      ::close(descriptor);
    }
  }
}

std::string lack_of_priority(const DaemonOptions& options) {
  const PipelineParams& pipeline = options.params.pipeline;
  const char* const ordinary = pipeline.sensor_priority == 0                                   ? "sensor"
                               : has_matcher(options.stages) && pipeline.matcher_priority == 0 ? "matcher"
                               : has_filter(options.stages) && pipeline.filter_priority == 0   ? "filter"
                                                                                               : nullptr;
  if (!options.require_realtime || ordinary == nullptr) {
    return "";
  }
  return fmt::format(
      "pipeline.{}_priority is 0: an ordinary thread, and real time is required (--require-realtime); "
      "1 to 98 is needed",
      ordinary);
}

Lack lack_of_descriptors(int connections) {
  std::vector<FileDescriptor> probes(static_cast<std::size_t>(kDescriptors + connections));
  for (std::size_t i = 0; i < probes.size(); ++i) {
    probes[i].reset(::eventfd(0, EFD_CLOEXEC));
    if (!probes[i].valid()) {
      const int error = errno;
      const std::size_t needed = probes.size();
      probes.clear();
      return {EX_OSERR, fmt::format("only {} files can be opened ({}), and {} are needed: the limit must be higher "
                                    "(ulimit -n, LimitNOFILE of systemd)",
                                    i, reason_of(error), needed)};
    }
  }
  return {};
}

Lack lack_of_folders(const DaemonOptions& options) {
  if (!options.folder.empty()) {
    if (Lack lack = lack_of_folder(options.folder, "--out"); lack.status != 0) {
      return lack;
    }
  }
  const std::filesystem::path recorder(options.params.recorder.path);
  return recorder.empty() ? Lack{} : lack_of_folder(recorder.parent_path(), "recorder.path");
}

Lack lack_of_memory(std::size_t map_cells) {
  const std::size_t size_bytes = map_cells * kSaved_bytes_per_cell + kOther_bytes;
  // Never touched: it counts against the limits, locked or not, and takes nothing.
  void* const probe = ::mmap(nullptr, size_bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (probe == MAP_FAILED) {
    return {EX_OSERR,
            fmt::format("memory: {:.1f} MB more are needed to run and to save the map: {}{}",
                        static_cast<double>(size_bytes) * kMbPerByte, reason_of(errno), memory_limits_text())};
  }
  ::munmap(probe, size_bytes);
  return {};
}

Lack lack_of_threads(int threads) {
  std::vector<std::unique_ptr<RealTimeThread>> probes;
  std::atomic<bool> over = false;
  int error = 0;
  for (int i = 0; i < threads && error == 0; ++i) {
    probes.push_back(std::make_unique<RealTimeThread>(ThreadParams{.name = "odo-probe"}));
    error = probes.back()->start([&over] { over.wait(false); });
  }
  over = true;
  over.notify_all();
  const std::size_t made = probes.size() - (error != 0 ? 1 : 0);
  probes.clear();  // joins
  return error == 0 ? Lack{}
                    : Lack{EX_OSERR, fmt::format("only {} of {} threads can be made ({}): the limit must be higher "
                                                 "(ulimit -u, TasksMax of systemd){}",
                                                 made, threads, reason_of(error), memory_limits_text())};
}

std::string memory_limits_text() {
  std::string text;
  if (const double all_mb = limit_mb(RLIMIT_AS); all_mb >= 0.0) {
    text += fmt::format("; the limit of memory is {:.1f} MB (ulimit -v, LimitAS of systemd)", all_mb);
  }
  // Who may lock any amount has locked more than that.
  const double locked_mb = static_cast<double>(locked_bytes()) * kMbPerByte;
  if (const double most_mb = limit_mb(RLIMIT_MEMLOCK); locked_mb > 0.0 && locked_mb <= most_mb) {
    text += fmt::format("; the limit of locked memory is {:.1f} MB (ulimit -l, LimitMEMLOCK of systemd)", most_mb);
  }
  return text;
}

}  // namespace odoless
