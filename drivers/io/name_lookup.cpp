#include "drivers/io/name_lookup.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <ctime>
#include <mutex>
#include <utility>

#include "rt/cpu_clock.hpp"

namespace odoless {

struct NameLookup::Request {
  explicit Request(std::string name) : host(std::move(name)) {
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    entry.ar_name = host.c_str();
    entry.ar_request = &hints;
  }
  ~Request() {
    if (entry.ar_result != nullptr) {
      ::freeaddrinfo(entry.ar_result);
    }
  }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;

  std::string host;
  addrinfo hints{};
  gaicb entry{};
};

namespace {

std::vector<std::string> numbers_of(const addrinfo* found) {
  std::vector<std::string> numbers;
  for (; found != nullptr && numbers.size() < NameLookup::kAddressesMax; found = found->ai_next) {
    std::array<char, NI_MAXHOST> text{};
    if (::getnameinfo(found->ai_addr, found->ai_addrlen, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) == 0) {
      numbers.emplace_back(text.data());
    }
  }
  return numbers;
}

// glibc's gai_suspend may also return before the lookup is done, with time left.
bool wait_for(gaicb& entry, std::int64_t patience_ns) {
  const std::array<const gaicb*, 1> list{&entry};
  const std::int64_t until_ns = monotonic_ns() + patience_ns;
  while (::gai_error(&entry) == EAI_INPROGRESS) {
    const std::int64_t left_ns = until_ns - monotonic_ns();
    if (left_ns <= 0) {
      return false;
    }
    const timespec left{.tv_sec = left_ns / 1'000'000'000, .tv_nsec = left_ns % 1'000'000'000};
    static_cast<void>(::gai_suspend(list.data(), 1, &left));
  }
  return true;
}

}  // namespace

NameLookup::NameLookup() = default;

NameLookup::~NameLookup() {
  if (request_ && ::gai_cancel(&request_->entry) == EAI_NOTCANCELED) {
    keep_until_done(std::move(request_));
  }
}

// Whoever looks a name up still writes there. What has been done meanwhile goes with the next one.
void NameLookup::keep_until_done(std::unique_ptr<Request> request) {
  static std::mutex mutex;
  static auto* const under_way = new std::vector<std::unique_ptr<Request>>;  // NOLINT: outlives every lookup
  const std::lock_guard lock(mutex);
  std::erase_if(*under_way, [](const auto& each) { return ::gai_error(&each->entry) != EAI_INPROGRESS; });
  under_way->push_back(std::move(request));
}

Result<std::vector<std::string>> NameLookup::find(const std::string& host, std::int64_t patience_ns) {
  std::array<std::byte, sizeof(in6_addr)> number{};
  if (::inet_pton(AF_INET, host.c_str(), number.data()) == 1 ||
      ::inet_pton(AF_INET6, host.c_str(), number.data()) == 1) {
    return std::vector{host};
  }
  if (!request_) {
    request_ = std::make_unique<Request>(host);
    std::array<gaicb*, 1> list{&request_->entry};
    if (::getaddrinfo_a(GAI_NOWAIT, list.data(), 1, nullptr) != 0) {
      request_.reset();
      return Errc::kDeviceMissing;
    }
  }
  if (!wait_for(request_->entry, patience_ns)) {
    return Errc::kDeviceMissing;
  }
  const std::unique_ptr<Request> done = std::move(request_);
  std::vector<std::string> numbers = numbers_of(done->entry.ar_result);
  if (numbers.empty()) {
    return Errc::kDeviceMissing;
  }
  return numbers;
}

}  // namespace odoless
