#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/web/live_view.hpp"
#include "firmware/web/web_params.hpp"

namespace odoless {

/// Serves the page to browsers over HTTP: the page itself (`/`), and what it shows as it changes (`/events`, which is
/// text/event-stream). It reads a LiveView and changes nothing, but for handing on the commands (POST `/command`) of
/// whoever knows the token; `/control` is there where there is one.
///
/// Thread: that of its owner; it has its own, which are ordinary and behind all others.
class WebServer {
 public:
  /// Carries out a command and answers, for a person; on any of the server's threads.
  using Commander = std::function<std::string(std::string_view line)>;

  /// @param commander  Empty: nothing can be commanded here, whatever the parameters say.
  WebServer(const WebParams& params, const LiveView& view, Commander commander = {});
  /// Ends within `kWritePatience_s`, which a browser that takes nothing can hold it up.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  WebServer(WebServer&&) = delete;
  WebServer& operator=(WebServer&&) = delete;

  /// Threads that it has when it runs.
  [[nodiscard]] static int threads(const WebParams& params);
  static constexpr int kWritePatience_s = 2;
  static constexpr std::size_t kStack_bytes = std::size_t{256} << 10;  ///< of each of them

  static constexpr std::size_t kCommandMax_bytes = 256;

  /// Reads the token and takes the address; connections wait until `start`. @return  What is wrong with it, for a
  /// person; empty: nothing.
  [[nodiscard]] std::string open();
  /// 0, or the errno for which there are no threads.
  [[nodiscard]] int start();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace odoless
