#include "tools/log/byte_stream.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <string>

#include "tools/command/error.hpp"
#include "tools/log/unpack.hpp"

namespace odoless {
namespace {

class FileStream : public ByteStream {
 public:
  explicit FileStream(const std::filesystem::path& path)
      : name_(path.string()), file_(std::fopen(name_.c_str(), "rb"), &std::fclose) {
    if (!file_) {
      throw NoInputError(name_ + ": cannot be opened: " + system_reason(errno));
    }
    if (std::filesystem::is_directory(path)) {
      throw NoInputError(name_ + ": is a directory; expected a file");
    }
  }

  std::size_t read(std::span<char> buffer) override {
    const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file_.get());
    if (got == 0 && std::ferror(file_.get()) != 0) {
      throw IoError(name_ + ": reading failed: " + system_reason(errno));
    }
    return got;
  }

 private:
  std::string name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

class MemoryStream : public ByteStream {
 public:
  explicit MemoryStream(std::string_view bytes) : bytes_(bytes) {}

  std::size_t read(std::span<char> buffer) override {
    const std::size_t got = bytes_.copy(buffer.data(), buffer.size());
    bytes_.remove_prefix(got);
    return got;
  }

 private:
  std::string_view bytes_;
};

/// A stream whose first bytes have been looked at already.
class PeekedStream : public ByteStream {
 public:
  explicit PeekedStream(std::unique_ptr<ByteStream> rest) : rest_(std::move(rest)) {
    while (size_ < head_.size()) {
      const std::size_t got = rest_->read(std::span(head_).subspan(size_));
      if (got == 0) {
        break;
      }
      size_ += got;
    }
  }

  [[nodiscard]] std::string_view head() const { return {head_.data(), size_}; }

  std::size_t read(std::span<char> buffer) override {
    if (taken_ == size_) {
      return rest_->read(buffer);
    }
    const std::size_t got = head().substr(taken_).copy(buffer.data(), buffer.size());
    taken_ += got;
    return got;
  }

 private:
  std::unique_ptr<ByteStream> rest_;
  std::array<char, 6> head_{};
  std::size_t size_ = 0;
  std::size_t taken_ = 0;
};

std::unique_ptr<ByteStream> unpack_if_packed(std::unique_ptr<ByteStream> packed, const std::string& name) {
  using namespace std::string_view_literals;
  auto peeked = std::make_unique<PeekedStream>(std::move(packed));
  if (peeked->head().starts_with("\x1f\x8b"sv)) {
    return unpack_gzip(std::move(peeked), name);
  }
  if (peeked->head() ==
      "\xfd"
      "7zXZ\0"sv) {
    return unpack_xz(std::move(peeked), name);
  }
  return peeked;
}

}  // namespace

std::unique_ptr<ByteStream> open_bytes(const std::filesystem::path& path) {
  return unpack_if_packed(std::make_unique<FileStream>(path), path.string());
}

std::unique_ptr<ByteStream> view_bytes(std::string_view bytes, const std::string& name) {
  return unpack_if_packed(std::make_unique<MemoryStream>(bytes), name);
}

}  // namespace odoless
