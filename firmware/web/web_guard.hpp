#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace odoless {

/// What of a request tells who asks, and from where: what a browser says of itself, which nobody can make it change.
struct WebRequest {
  std::string method{};
  std::string path{};
  std::vector<std::string> hosts{};  ///< every `Host`
  std::string origin{};              ///< `Origin`; empty: none
  std::string fetch_site{};          ///< `Sec-Fetch-Site`, and the others of its kind; empty: none
  std::string fetch_mode{};
  std::string fetch_destination{};
};

/// Where commands are posted, and nothing else is.
inline constexpr const char* kCommandPath = "/command";

/// The status with which a request is refused; 0: it is served. Only GET is, and POST of a command, of a host that is
/// named as this one may be (an address, or one of `names`: not one that a stranger has let point here), and never for
/// a page of another origin. A link from anywhere may be followed. Whether a command may be asked for is another
/// question.
[[nodiscard]] int refusal_of(const WebRequest& request, std::span<const std::string> names);

/// Names by which this host may be called: localhost, its own, and that of the configuration.
[[nodiscard]] std::vector<std::string> own_names(const std::string& configured);

/// Whether a `Host` names this host: an address, which no name server has a say in, or one of `names`.
[[nodiscard]] bool is_own_host(std::string_view host, std::span<const std::string> names);

}  // namespace odoless
