#include "firmware/web/web_server.hpp"

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "firmware/threads/round.hpp"
#include "firmware/web/page.hpp"
#include "firmware/web/web_guard.hpp"
#include "firmware/web/web_threads.hpp"
#include "firmware/web/web_token.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr int kPageThreads = 4;  // for what is not a stream
constexpr int kUnauthorized = 401;
constexpr int kReadOnly = 403;
constexpr int kBusy = 503;
constexpr std::int64_t kTellEvery_ns = 100'000'000;
constexpr int kReadPatience_s = 2;

WebRequest what_is_asked(const httplib::Request& request) {
  WebRequest asked{.method = request.method,
                   .path = request.path,
                   .origin = request.get_header_value("Origin"),
                   .fetch_site = request.get_header_value("Sec-Fetch-Site"),
                   .fetch_mode = request.get_header_value("Sec-Fetch-Mode"),
                   .fetch_destination = request.get_header_value("Sec-Fetch-Dest")};
  for (auto [header, end] = request.headers.equal_range("Host"); header != end; ++header) {
    asked.hosts.push_back(header->second);
  }
  return asked;
}

// Nothing of another host is loaded, nobody else shows or reads the page, and nothing of it is kept.
httplib::Headers headers_of_all() {
  return {
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri 'none'; "
       "form-action 'none'; frame-ancestors 'none'"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cache-Control", "no-store"}};
}

// Not shared with another program that listens there, but at once free after this one.
void set_listener_options(int socket) {
  const int yes = 1;
  static_cast<void>(::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)));
}

}  // namespace

struct WebServer::Parts {
  Parts(const WebParams& the_params, const LiveView& the_view, Commander the_commander)
      : params(the_params), view(the_view), commander(std::move(the_commander)), names(own_names(the_params.name)) {
    server.set_keep_alive_max_count(1);
    server.set_keep_alive_timeout(kReadPatience_s);  // for the first byte
    server.set_read_timeout(kReadPatience_s);
    server.set_write_timeout(kWritePatience_s);
    server.set_tcp_nodelay(true);
    server.set_payload_max_length(kCommandMax_bytes);
    server.set_socket_options([this](int socket) {
      set_listener_options(socket);
      unstarted = socket;
    });
    server.set_default_headers(headers_of_all());
    server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      response.status = refusal_of(what_is_asked(request), names);
      response.status =
          response.status == 0 && request.method == "POST" ? refusal_of_command(request) : response.status;
      const bool is_refused = response.status != 0;
      response.status = is_refused ? response.status : -1;
      return is_refused ? httplib::Server::HandlerResponse::Handled : httplib::Server::HandlerResponse::Unhandled;
    });
    serve("/", kPageHtml, "text/html; charset=utf-8");
    serve("/page.js", kPageScript, "text/javascript; charset=utf-8");
    serve("/page.css", kPageStyle, "text/css; charset=utf-8");
    server.Get("/control", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(token.text.empty() ? "no" : "yes", "text/plain");
    });
    server.Post(kCommandPath, [this](const httplib::Request& request, httplib::Response& response) {
      response.set_content(commander(request.body), "text/plain; charset=utf-8");
    });
    server.Get("/events", [this](const httplib::Request&, httplib::Response& response) { stream(response); });
  }

  /// Before any of it is read. The status, 0: it is carried out.
  [[nodiscard]] int refusal_of_command(const httplib::Request& request) const {
    if (token.text.empty()) {
      return kReadOnly;
    }
    return token.allows(request.get_header_value("Authorization")) ? 0 : kUnauthorized;
  }

  void serve(const char* path, std::string_view text, const char* type) {
    server.Get(path, [text, type](const httplib::Request&, httplib::Response& response) {
      response.set_content(text.data(), text.size(), type);
    });
  }

  void stream(httplib::Response& response) {
    if (++streams > params.clients_max) {
      --streams;
      response.status = kBusy;
      return;
    }
    auto cursor = std::make_shared<LiveCursor>();
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, cursor](std::size_t, httplib::DataSink& sink) {
          std::string events;
          view.tell(*cursor, monotonic_ns(), events);
          const bool taken = events.empty() || sink.write(events.data(), events.size());
          sleep_ns(kTellEvery_ns);
          return taken && !stopping;
        },
        [this](bool) { --streams; });
  }

  const WebParams params;
  const LiveView& view;
  const Commander commander;
  WebToken token;
  const std::vector<std::string> names;
  int unstarted = -1;  ///< the listening socket, which httplib closes only once it is in use
  std::atomic<int> streams = 0;
  std::atomic<bool> stopping = false;
  httplib::Server server;
  std::unique_ptr<WebThreads> threads = std::make_unique<WebThreads>();
  RealTimeThread listener{{.name = "odo-web", .stack_bytes = kStack_bytes}};
};

WebServer::WebServer(const WebParams& params, const LiveView& view, Commander commander)
    : parts_(std::make_unique<Parts>(params, view, std::move(commander))) {}

WebServer::~WebServer() {
  parts_->stopping = true;
  parts_->server.stop();
  if (parts_->unstarted >= 0) {
    ::close(parts_->unstarted);
  }
}

int WebServer::threads(const WebParams& params) { return params.is_used() ? params.clients_max + kPageThreads + 1 : 0; }

std::string WebServer::open() {
  const WebParams& params = parts_->params;
  const std::optional<TcpAddress> address = params.address();
  if (!address) {
    return params.contradiction();
  }
  if (parts_->commander && !params.token_file.empty()) {
    std::variant<WebToken, std::string> token = read_token(params.token_file);
    if (const auto* const wrong = std::get_if<std::string>(&token)) {
      return fmt::format("web.token_file: {}", *wrong);
    }
    parts_->token = std::get<WebToken>(std::move(token));
  }
  errno = 0;
  if (!parts_->server.bind_to_port(address->host, address->port)) {
    parts_->unstarted = -1;                                                        // it is closed
    const std::string reason = std::strerror(errno != 0 ? errno : EADDRNOTAVAIL);  // NOLINT(concurrency-mt-unsafe)
    return fmt::format(
        "web.listen = \"{}\": the page cannot be served there: {}; an address of this host is needed, "
        "with a port that no other program has",
        params.listen, reason);
  }
  return "";
}

int WebServer::start() {
  if (const int error = parts_->threads->start(threads(parts_->params) - 1, kStack_bytes); error != 0) {
    return error;
  }
  parts_->server.new_task_queue = [this] { return parts_->threads.release(); };
  const int error = parts_->listener.start([this] {
    yield_to_others();
    parts_->server.listen_after_bind();
  });
  while (error == 0 && !parts_->server.is_running()) {
    sleep_ns(1'000'000);  // one that does not listen yet cannot be stopped
  }
  parts_->unstarted = error == 0 ? -1 : parts_->unstarted;
  return error;
}

}  // namespace odoless
