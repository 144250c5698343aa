// What the bridge uses of rclcpp, as far as a test needs it: topics are lists in memory. See https://docs.ros.org.
#pragma once

#include <any>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#define RCLCPP_INFO(logger, ...) rclcpp::log(__VA_ARGS__)
#define RCLCPP_WARN(logger, ...) rclcpp::log(__VA_ARGS__)
#define RCLCPP_ERROR(logger, ...) rclcpp::log(__VA_ARGS__)

namespace rclcpp {

/// All that was published and logged, parameters, and who listens: of all nodes of the test.
struct World {
  std::mutex mutex{};
  std::map<std::string, std::vector<std::any>> published{};
  std::map<std::string, std::function<void(const std::any&)>> listeners{};
  std::map<std::string, std::any> parameters{};
  std::vector<std::string> logged{};
};

inline World& world() {
  static World the_world;
  return the_world;
}

template <class... Values>
void log(const char* format, Values... values) {
  std::string text(format);
  if constexpr (sizeof...(Values) > 0) {
    text.assign(4096, '\0');
    text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), format, values...)));
  }
  const std::scoped_lock lock(world().mutex);
  world().logged.push_back(text);
}

struct QoS {
  explicit QoS(std::size_t /*depth*/) {}
  QoS& transient_local() { return *this; }
};
struct SensorDataQoS : QoS {
  SensorDataQoS() : QoS(5) {}
};

template <class Message>
class Publisher {
 public:
  using SharedPtr = std::shared_ptr<Publisher>;
  explicit Publisher(std::string topic) : topic_(std::move(topic)) {}
  void publish(const Message& message) {
    const std::scoped_lock lock(world().mutex);
    world().published[topic_].push_back(message);
  }

 private:
  std::string topic_;
};

template <class Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
};

struct Logger {};

class Node {
 public:
  explicit Node(const std::string& /*name*/) {}
  virtual ~Node() = default;

  template <class Value>
  Value declare_parameter(const std::string& name, const Value& otherwise) {
    const auto found = world().parameters.find(name);
    return found == world().parameters.end() ? otherwise : std::any_cast<Value>(found->second);
  }

  template <class Message>
  typename Publisher<Message>::SharedPtr create_publisher(const std::string& topic, const QoS& /*quality*/) {
    return std::make_shared<Publisher<Message>>(topic);
  }

  template <class Message, class Callback>
  typename Subscription<Message>::SharedPtr create_subscription(const std::string& topic, const QoS& /*quality*/,
                                                                Callback callback) {
    world().listeners[topic] = [callback](const std::any& message) {
      callback(std::any_cast<const Message&>(message));
    };
    return std::make_shared<Subscription<Message>>();
  }

  [[nodiscard]] Logger get_logger() const { return {}; }
};

}  // namespace rclcpp
