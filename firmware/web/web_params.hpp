#pragma once

#include <optional>
#include <string>

#include "core/base/parameters.hpp"
#include "drivers/io/device_address.hpp"

namespace odoless {

/// The page that shows in a browser what the daemon does.
struct WebParams {
  std::string listen;
  std::string name;
  int clients_max = 24;

  [[nodiscard]] bool is_used() const { return !listen.empty(); }
  /// What `listen` says; none where that is no address with a port.
  [[nodiscard]] std::optional<TcpAddress> address() const;
  /// What is wrong with `listen`, for a person; empty: nothing, or there is no page.
  [[nodiscard]] std::string contradiction() const;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("listen", self.listen,
               "ADDRESS:PORT of the page, as in 127.0.0.1:8080 for this host alone or 0.0.0.0:8080 for all; empty: no "
               "page. Everyone who can reach it can see everything and change nothing.");
    visit.text("name", self.name,
               "Name by which browsers may also call this host; its addresses, localhost and its own name, with and "
               "without .local, hold in any case.");
    visit.value("clients_max", self.clients_max, Range{1, 64}, "Browsers that can watch at the same time.");
  }
};

}  // namespace odoless
