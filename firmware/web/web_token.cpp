#include "firmware/web/web_token.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

bool WebToken::allows(std::string_view authorization) const {
  constexpr std::string_view kScheme = "Bearer ";
  if (text.empty() || !authorization.starts_with(kScheme)) {
    return false;
  }
  const std::string_view said = authorization.substr(kScheme.size());
  std::size_t different = said.size() ^ text.size();
  for (std::size_t i = 0; i < said.size(); ++i) {
    different |= static_cast<unsigned char>(said[i] ^ text[i % text.size()]);
  }
  return different == 0;
}

std::variant<WebToken, std::string> read_token(const std::string& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat about {};
  if (!file.valid() || ::fstat(file.get(), &about) != 0) {
    return fmt::format("{}: cannot be read: {}", path, std::strerror(errno));  // NOLINT(concurrency-mt-unsafe)
  }
  if (!S_ISREG(about.st_mode) || (about.st_mode & S_IROTH) != 0) {
    return fmt::format("{}: must be a file that not everybody may read: chmod o-r {}", path, path);
  }
  std::array<char, kTokenMax_bytes + 2> bytes{};
  const ssize_t size_bytes = ::read(file.get(), bytes.data(), bytes.size());
  std::string text(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(size_bytes, 0)));
  if (text.ends_with('\n')) {
    text.pop_back();
  }
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
  if (!is_plain || text.size() < kTokenMin_bytes || text.size() > kTokenMax_bytes) {
    return fmt::format(
        "{}: must have one line of {} to {} letters, digits and signs without spaces: openssl rand -hex 16 makes one",
        path, kTokenMin_bytes, kTokenMax_bytes);
  }
  return WebToken{text};
}

}  // namespace odoless
