#include "firmware/daemon/saver.hpp"

#include <fmt/format.h>

#include "firmware/daemon/log.hpp"

namespace odoless {

Saver::Saver(const DaemonOptions& options, Machine& machine) : options_(options), machine_(machine) {}

int Saver::start() {
  return thread_.start([this] { run(); });
}

Saver::~Saver() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.started()) {
    thread_.join();
  }
}

bool Saver::begin(const SaveRequest& request) {
  const std::lock_guard lock(mutex_);
  if (status_.state == SaveStatus::State::kSaving) {
    return false;
  }
  request_ = request;
  since_ns_ = progress_ns_ = machine_.clock().now_ns();
  status_ = {.state = SaveStatus::State::kSaving, .doing = "rendering the map"};
  changed_.notify_all();
  return true;
}

SaveStatus Saver::status() const {
  const std::lock_guard lock(mutex_);
  SaveStatus status = status_;
  status.since_s = static_cast<double>(machine_.clock().now_ns() - since_ns_) * 1e-9;
  return status;
}

int Saver::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

std::int64_t Saver::progress_ns() const {
  const std::lock_guard lock(mutex_);
  return progress_ns_;
}

void Saver::run() {
  while (true) {
    SaveRequest request;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return is_ending_ || status_.state == SaveStatus::State::kSaving; });
      if (status_.state != SaveStatus::State::kSaving) {
        return;
      }
      request = request_;
    }
    save(request);
  }
}

void Saver::save(const SaveRequest& request) {
  const std::int64_t begin_ns = machine_.clock().now_ns();
  const SaveOutcome outcome = options_.save(
      request, [&] { return machine_.result(request.is_last); }, [this](const std::string& doing) { tell(doing); });
  const std::int64_t end_ns = machine_.clock().now_ns();
  const bool is_good = outcome.wrong.empty();
  log_line(is_good ? EventPriority::kNotice : EventPriority::kError,
           is_good
               ? fmt::format("saved in {}, in {:.1f} s", outcome.folder, static_cast<double>(end_ns - begin_ns) * 1e-9)
               : fmt::format("not saved: {}", outcome.wrong));
  const std::lock_guard lock(mutex_);
  error_ = is_good ? 0 : outcome.error;
  since_ns_ = progress_ns_ = end_ns;
  status_ = {.state = is_good ? SaveStatus::State::kSaved : SaveStatus::State::kFailed,
             .folder = outcome.folder,
             .wrong = outcome.wrong};
}

void Saver::tell(const std::string& doing) {
  const std::lock_guard lock(mutex_);
  status_.doing = doing;
  progress_ns_ = machine_.clock().now_ns();
}

}  // namespace odoless
