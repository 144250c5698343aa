#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace odoless {

/// Finds the addresses of a host by its name, and holds nobody up: what takes longer than the caller waits goes on
/// meanwhile (getaddrinfo_a), and is there when it is asked for again.
///
/// Thread: one ordinary thread.
class NameLookup {
 public:
  static constexpr std::int64_t kPatience_ns = 300'000'000;
  static constexpr std::size_t kAddressesMax = 3;

  NameLookup();
  ~NameLookup();
  NameLookup(const NameLookup&) = delete;
  NameLookup& operator=(const NameLookup&) = delete;
  NameLookup(NameLookup&&) = delete;
  NameLookup& operator=(NameLookup&&) = delete;

  /// Numeric addresses of that host, at least one; a numeric host is its own. A name is looked up anew each time that
  /// it has been found, for it may move. Errors: Errc::kDeviceMissing (it is not known, or not yet).
  [[nodiscard]] Result<std::vector<std::string>> find(const std::string& host, std::int64_t patience_ns = kPatience_ns);

 private:
  struct Request;
  static void keep_until_done(std::unique_ptr<Request> request);
  std::unique_ptr<Request> request_;  ///< under way; null: none
};

}  // namespace odoless
