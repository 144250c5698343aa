#include "tests/support/private_network.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace odoless::test {
namespace {

std::string reason(const char* what) { return std::string(what) + ": " + std::generic_category().message(errno); }

sockaddr as_address(const char* text) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, text, &address.sin_addr);
  sockaddr out{};
  static_assert(sizeof(address) <= sizeof(out));
  std::memcpy(&out, &address, sizeof(address));
  return out;
}

std::string raise_loopback() {
  const int control = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq device{};
  std::strncpy(device.ifr_name, "lo", IFNAMSIZ - 1);
  device.ifr_flags = IFF_UP | IFF_RUNNING;
  rtentry route{};
  char name[] = "lo";
  route.rt_dst = as_address("224.0.0.0");
  route.rt_genmask = as_address("240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = name;
  std::string wrong;
  if (ioctl(control, SIOCSIFFLAGS, &device) != 0) {
    wrong = reason("loopback");
  } else if (ioctl(control, SIOCADDRT, &route) != 0) {
    wrong = reason("route for multicast");
  }
  close(control);
  return wrong;
}

bool host_has_multicast() {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr group = as_address("239.255.76.67");
  reinterpret_cast<sockaddr_in*>(&group)->sin_port = htons(9);
  const bool routed = connect(probe, &group, sizeof(group)) == 0;
  close(probe);
  return routed;
}

bool leave_the_hosts() { return unshare(CLONE_NEWNET) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0; }

std::string enter() {
  if (leave_the_hosts()) {
    return raise_loopback();
  }
  const std::string refused = reason("unshare");
  return host_has_multicast() ? "" : refused + ", and the host has no route for multicast";
}

}  // namespace

std::string enter_private_network() {
  static const std::string wrong = enter();
  return wrong;
}

std::string enter_dead_network() { return leave_the_hosts() ? "" : reason("unshare"); }

std::string raise_network() { return raise_loopback(); }

std::string lcm_url() { return "udpm://239.255.76.67:" + std::to_string(20'000 + getpid() % 20'000); }

}  // namespace odoless::test
