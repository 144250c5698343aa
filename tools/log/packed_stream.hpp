#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "tools/log/byte_stream.hpp"

namespace odoless {

/// The packed side of a decoder.
class PackedInput {
 public:
  PackedInput(std::unique_ptr<ByteStream> packed, std::string name)
      : packed_(std::move(packed)), name_(std::move(name)) {}

  /// The next chunk; empty at the end.
  std::span<const char> next() { return std::span(chunk_).first(packed_->read(chunk_)); }

  [[noreturn]] void fail_cut() const;
  [[noreturn]] void fail_damaged() const;

 private:
  static constexpr std::size_t kChunkBytes = std::size_t{64} * 1024;

  std::unique_ptr<ByteStream> packed_;
  std::string name_;
  std::array<char, kChunkBytes> chunk_{};
};

/// Unpacks one or more frames, one after the other, with the decoder of a derived class.
class PackedStream : public ByteStream {
 public:
  PackedStream(std::unique_ptr<ByteStream> packed, const std::string& name) : input_(std::move(packed), name) {}

  std::size_t read(std::span<char> buffer) override;

 protected:
  /// Makes the decoder ready for a further frame.
  virtual void begin_frame() = 0;

  /// Decodes from the front of `in` to the front of `out`, and removes from both what it used. False at the frame's
  /// end.
  virtual bool step(std::span<const char>& in, std::span<char>& out) = 0;

  [[noreturn]] void fail_damaged() const { input_.fail_damaged(); }

 private:
  [[nodiscard]] bool refill();

  PackedInput input_;
  std::span<const char> in_;
  bool inside_frame_ = true;
  bool has_more_ = false;  ///< the decoder may hold bytes for which there was no room
};

}  // namespace odoless
