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

using namespace std::string_view_literals;

/// The files of a ROS 2 bag, which is a directory.
std::string bags_in(const std::filesystem::path& directory) {
  std::string list;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(directory, ignored)) {
    const std::filesystem::path extension = entry.path().extension();
    if (extension == ".mcap" || extension == ".db3") {
      list += (list.empty() ? ", such as " : ", ") + entry.path().string();
    }
  }
  return list;
}

class FileStream : public ByteStream {
 public:
  explicit FileStream(const std::filesystem::path& path)
      : name_(path.string()), file_(std::fopen(name_.c_str(), "rb"), &std::fclose) {
    if (!file_) {
      throw NoInputError(name_ + ": cannot be opened: " + system_reason(errno));
    }
    if (std::filesystem::is_directory(path)) {
      throw NoInputError(name_ + ": is a directory; expected a file" + bags_in(path));
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

/// How a kind of packed file begins.
struct Packing {
  std::string_view magic;
  std::unique_ptr<ByteStream> (*unpack)(std::unique_ptr<ByteStream> packed, const std::string& name);
};

constexpr std::array<Packing, 5> kPackings{{
    {"\x1f\x8b"sv, unpack_gzip},
    {"\xfd\x37zXZ\0"sv, unpack_xz},
    {"BZh"sv, unpack_bzip2},
    {"\x04\x22\x4d\x18"sv, unpack_lz4},
    {"\x28\xb5\x2f\xfd"sv, unpack_zstd},
}};

std::unique_ptr<ByteStream> unpack_if_packed(std::unique_ptr<ByteStream> packed, const std::string& name) {
  auto peeked = std::make_unique<PeekedStream>(std::move(packed));
  for (const Packing& packing : kPackings) {
    if (peeked->head().starts_with(packing.magic)) {
      return packing.unpack(std::move(peeked), name);
    }
  }
  return peeked;
}

}  // namespace

PeekedStream::PeekedStream(std::unique_ptr<ByteStream> rest) : rest_(std::move(rest)) {
  std::size_t got = 1;
  while (size_ < head_.size() && got > 0) {
    got = rest_->read(std::span(head_).subspan(size_));
    size_ += got;
  }
}

std::size_t PeekedStream::read(std::span<char> buffer) {
  if (taken_ == size_) {
    return rest_->read(buffer);
  }
  const std::size_t got = head().substr(taken_).copy(buffer.data(), buffer.size());
  taken_ += got;
  return got;
}

std::unique_ptr<ByteStream> open_bytes(const std::filesystem::path& path) {
  return unpack_if_packed(std::make_unique<FileStream>(path), path.string());
}

std::unique_ptr<ByteStream> view_bytes(std::string_view bytes, const std::string& name) {
  return unpack_if_packed(std::make_unique<MemoryStream>(bytes), name);
}

}  // namespace odoless
