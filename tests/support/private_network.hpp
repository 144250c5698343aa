#pragma once

#include <string>

namespace odoless::test {

/// A network for this process alone, in which multicast stays on the loopback device: tests neither hear nor disturb
/// anybody, and need no route of the host. Entered once; the threads started later are in it too.
///
/// @return  Why there is none and the host's network has no multicast either; empty if tests can go on.
[[nodiscard]] std::string enter_private_network();

/// A network for this process alone that leads nowhere, as on a host without one. @return  Why there is none.
[[nodiscard]] std::string enter_dead_network();
/// The same network comes up: multicast stays on the loopback device. @return  Why it doesn't.
[[nodiscard]] std::string raise_network();

/// An address of LCM for the calling process. In a private network it could be the same for all; on the host's it is
/// not.
[[nodiscard]] std::string lcm_url();

}  // namespace odoless::test

/// At the start of a test that needs a network; skips it where there is none, saying why.
#define ODOLESS_NEEDS_NETWORK()                                                      \
  do {                                                                               \
    const std::string why_no_network = ::odoless::test::enter_private_network();     \
    if (!why_no_network.empty()) {                                                   \
      GTEST_SKIP() << "no network with multicast for this test: " << why_no_network; \
    }                                                                                \
  } while (false)
