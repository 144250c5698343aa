#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/tools/emulate_support.hpp"

namespace odoless::test {

/// A session and an emulated laser on a line without delay, in made-up time, where some requests are answered in the
/// laser's stead: it refuses, is broken, or is of a kind that the emulator does not know.
class AnsweredLine {
 public:
  AnsweredLine(const std::string& model, const LrfParams& params, EmulatedLrfOptions options = {}, int beams_max = 2048)
      : source_(period_ns_of(model), small_drive()),
        device_(make_emulated_lrf(model, source_, std::move(options), now_ns_)),
        session_(make_lrf_session(params, beams_max)) {}

  void reset() { session_->reset(now_ns_); }
  void run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kMs) {
      step();
    }
  }

  /// The laser says something unasked.
  void say(const std::string& bytes) {
    session_->receive(std::as_bytes(std::span(bytes.data(), bytes.size())), now_ns_, heard_);
  }

  /// What is answered to a request that the laser does not hear; nothing: it hears and answers itself.
  std::function<std::optional<std::string>(const std::string& request)> in_its_stead = [](const std::string&) {
    return std::optional<std::string>();
  };

  /// Answers the requests that begin so, `times` times. @param at  What comes before does not count.
  void answer_instead(const std::string& beginning, const std::string& answer, int times = 1000, std::size_t at = 0) {
    in_its_stead = [=, left = times](const std::string& request) mutable {
      const bool is_it = left > 0 && request.size() > at && request.compare(at, beginning.size(), beginning) == 0;
      left -= is_it ? 1 : 0;
      return is_it ? std::optional(answer) : std::nullopt;
    };
  }

  [[nodiscard]] LrfSession& session() { return *session_; }
  template <class Session>
  [[nodiscard]] Session& session_as() {
    return dynamic_cast<Session&>(*session_);
  }
  template <class Device>
  [[nodiscard]] Device& device_as() {
    return dynamic_cast<Device&>(*device_);
  }
  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  [[nodiscard]] const Heard& heard() const { return heard_; }
  /// All requests, in order.
  [[nodiscard]] const std::vector<std::string>& requests() const { return requests_; }
  [[nodiscard]] int asked(const std::string& request) const {
    return static_cast<int>(std::ranges::count(requests_, request));
  }
  void forget_requests() { requests_.clear(); }

 private:
  void step() {
    const auto bytes = session_->transmit();
    const std::string request(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    device_->set_line_baud(session_->line_baud());
    std::string arrived;
    if (!request.empty()) {
      requests_.push_back(request);
      if (const std::optional<std::string> answer = in_its_stead(request)) {
        arrived = *answer;
      } else {
        device_->receive(request, now_ns_);
      }
    }
    device_->tick(now_ns_);
    for (const SentBytes& sent : device_->take_output()) {
      arrived += sent.bytes;
    }
    say(arrived);
    session_->tick(now_ns_, heard_);
  }

  std::int64_t now_ns_ = 1000 * kSecond;
  WorldSource source_;
  std::unique_ptr<EmulatedLrf> device_;
  std::unique_ptr<LrfSession> session_;
  Heard heard_;
  std::vector<std::string> requests_;
};

}  // namespace odoless::test
