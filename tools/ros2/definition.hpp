#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace odoless::ros {

namespace detail {

/// How a .msg file names a type; of messages their own name.
template <class Field>
struct TypeName {
  using Message = Field;
  static std::string text() { return Field::kType; }
};

template <class Number>
requires std::is_arithmetic_v<Number>
struct TypeName<Number> {
  using Message = void;
  static std::string text() {
    const std::string bits = std::to_string(8 * sizeof(Number));
    return (std::is_floating_point_v<Number> ? "float" : std::is_signed_v<Number> ? "int" : "uint") + bits;
  }
};

template <>
struct TypeName<std::string> {
  using Message = void;
  static std::string text() { return "string"; }
};

template <class Element>
struct TypeName<std::vector<Element>> {
  using Message = typename TypeName<Element>::Message;
  static std::string text() { return TypeName<Element>::text() + "[]"; }
};

template <class Element, std::size_t kSize>
struct TypeName<std::array<Element, kSize>> {
  using Message = typename TypeName<Element>::Message;
  static std::string text() { return TypeName<Element>::text() + "[" + std::to_string(kSize) + "]"; }
};

}  // namespace detail

/// A message's fields as a .msg file has them, and behind it the same of each message within it: what MCAP calls the
/// encoding ros2msg.
class Definition {
 public:
  template <class Message>
  [[nodiscard]] static std::string of() {
    Definition definition;
    definition.add<Message>();
    std::string text = definition.parts_.front().fields;
    for (std::size_t i = 1; i < definition.parts_.size(); ++i) {
      text += std::string(80, '=') + "\nMSG: " + definition.parts_[i].type + "\n" + definition.parts_[i].fields;
    }
    return text;
  }

  template <class Field>
  void operator()(const char* name, const Field&) {
    using Name = detail::TypeName<Field>;
    parts_[at_].fields += Name::text() + " " + name + "\n";
    if constexpr (!std::is_void_v<typename Name::Message>) {
      add<typename Name::Message>();
    }
  }

 private:
  struct Part {
    std::string type;
    std::string fields;
  };

  template <class Message>
  void add() {
    const auto is_it = [](const Part& part) { return part.type == Message::kType; };
    if (std::none_of(parts_.begin(), parts_.end(), is_it)) {
      const std::size_t around = at_;
      at_ = parts_.size();
      parts_.push_back({Message::kType, ""});
      const Message message{};
      Message::describe(message, *this);
      at_ = around;
    }
  }

  std::vector<Part> parts_;
  std::size_t at_ = 0;
};

/// "nav_msgs/Path" as ROS 2 says it: "nav_msgs/msg/Path".
template <class Message>
[[nodiscard]] std::string type_name() {
  const std::string name = Message::kType;
  const std::size_t slash = name.find('/');
  return name.substr(0, slash) + "/msg" + name.substr(slash);
}

}  // namespace odoless::ros
