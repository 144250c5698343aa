#pragma once

#include <unistd.h>

#include <utility>

namespace odoless {

/// Owns a file descriptor and closes it in the end.
///
/// Thread: owned by one thread. Real time: reading `get` only; opening and closing are for ordinary threads.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  FileDescriptor(FileDescriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    if (this != &other) {
      reset(std::exchange(other.descriptor_, -1));
    }
    return *this;
  }
  ~FileDescriptor() { reset(); }

  /// -1 when nothing is owned.
  [[nodiscard]] int get() const { return descriptor_; }
  [[nodiscard]] bool valid() const { return descriptor_ >= 0; }

  /// Gives the descriptor away unclosed.
  [[nodiscard]] int release() { return std::exchange(descriptor_, -1); }

  /// Closes what is owned and owns `descriptor` from now on.
  void reset(int descriptor = -1) {
    if (valid()) {
      static_cast<void>(::close(descriptor_));
    }
    descriptor_ = descriptor;
  }

 private:
  int descriptor_ = -1;
};

}  // namespace odoless
