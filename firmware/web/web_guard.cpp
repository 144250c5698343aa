#include "firmware/web/web_guard.hpp"

#include <arpa/inet.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstddef>

namespace odoless {
namespace {

constexpr int kForbidden = 403;
constexpr int kMethodNotAllowed = 405;
constexpr int kMisdirected = 421;

bool is_address(int family, const std::string& text) {
  std::array<std::byte, sizeof(in6_addr)> address{};
  return ::inet_pton(family, text.c_str(), address.data()) == 1;
}

// Without the port; what has no such form is left as it is.
std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::string_view port = colon == std::string_view::npos ? std::string_view() : host.substr(colon + 1);
  const bool is_port = port.find_first_not_of("0123456789") == std::string_view::npos;
  return colon != std::string_view::npos && is_port ? host.substr(0, colon) : host;
}

// Of those that a browser tells of a request: one that this page itself, or the person at the browser, has made.
bool is_from_elsewhere(const WebRequest& request) {
  const bool is_link_followed =
      request.method == "GET" && request.fetch_mode == "navigate" && request.fetch_destination == "document";
  return !request.fetch_site.empty() && request.fetch_site != "same-origin" && request.fetch_site != "none" &&
         !is_link_followed;
}

}  // namespace

bool is_own_host(std::string_view host, std::span<const std::string> names) {
  const std::string name(without_port(host));
  if (name.size() > 2 && name.front() == '[' && name.back() == ']') {
    return is_address(AF_INET6, name.substr(1, name.size() - 2));
  }
  return is_address(AF_INET, name) || std::any_of(names.begin(), names.end(), [&name](const std::string& own) {
           return ::strcasecmp(name.c_str(), own.c_str()) == 0;
         });
}

std::vector<std::string> own_names(const std::string& configured) {
  std::vector<std::string> names{"localhost"};
  std::array<char, HOST_NAME_MAX + 1> host{};
  if (::gethostname(host.data(), host.size() - 1) == 0 && host[0] != '\0') {
    names.emplace_back(host.data());
    names.push_back(names.back() + ".local");
  }
  if (!configured.empty()) {
    names.push_back(configured);
  }
  return names;
}

int refusal_of(const WebRequest& request, std::span<const std::string> names) {
  if (request.method != "GET" && (request.method != "POST" || request.path != kCommandPath)) {
    return kMethodNotAllowed;
  }
  if (request.hosts.size() != 1 || !is_own_host(request.hosts.front(), names)) {
    return kMisdirected;
  }
  const bool is_foreign = !request.origin.empty() && request.origin != "http://" + request.hosts.front();
  return is_foreign || is_from_elsewhere(request) ? kForbidden : 0;
}

}  // namespace odoless
