#include "tools/emulate/sdo_server.hpp"

#include <algorithm>

namespace odoless {
namespace {

using canopen::Object;

constexpr int kSdoBytes = 8;
constexpr std::size_t kInSegment = 7;
constexpr std::size_t kTransferMax = 1024;
constexpr std::uint8_t kToggle = 0x10;

/// The client's command specifiers: the highest three bits of the first byte.
enum Specifier : std::uint8_t {
  kDownloadSegment = 0,
  kBeginDownload = 1,
  kBeginUpload = 2,
  kUploadSegment = 3,
  kAbortTransfer = 4,
};

Object object_of(const CanFrame& request) {
  return {static_cast<std::uint16_t>(canopen::get(request, 1, 2)), request.data[3]};
}

std::string bytes_of(const CanFrame& request, std::size_t at, std::size_t count) {
  const auto* const begin = reinterpret_cast<const char*>(request.data.data()) + at;
  return {begin, count};
}

}  // namespace

CanFrame SdoServer::frame(std::uint8_t command, Object object, std::uint32_t value) const {
  CanFrame reply;
  reply.id = canopen::kSdoReplyCob + static_cast<std::uint32_t>(node_);
  reply.size_bytes = kSdoBytes;
  reply.data[0] = command;
  canopen::put(reply, 1, object.index, 2);
  reply.data[3] = object.sub;
  canopen::put(reply, 4, value, 4);
  return reply;
}

CanFrame SdoServer::abort(Object object, std::uint32_t code) {
  transfer_.reset();
  return frame(0x80, object, code);
}

std::optional<CanFrame> SdoServer::answer(const CanFrame& request, ObjectDictionary& dictionary,
                                          std::optional<Object>& written) {
  written.reset();
  if (request.size_bytes != kSdoBytes) {
    return std::nullopt;
  }
  switch (request.data[0] >> 5U) {
    case kBeginDownload:
      return begin_download(request, dictionary, written);
    case kBeginUpload:
      return begin_upload(request, dictionary);
    case kDownloadSegment:
      return transfer_ && transfer_->is_download ? download_segment(request, dictionary, written)
                                                 : abort({}, kCommandAbort);
    case kUploadSegment:
      return transfer_ && !transfer_->is_download ? upload_segment(request) : abort({}, kCommandAbort);
    case kAbortTransfer:
      transfer_.reset();
      return std::nullopt;
    default:  // transfers by blocks
      return abort(object_of(request), kCommandAbort);
  }
}

CanFrame SdoServer::begin_download(const CanFrame& request, ObjectDictionary& dictionary,
                                   std::optional<Object>& written) {
  const Object object = object_of(request);
  const bool is_expedited = (request.data[0] & 0x02U) != 0;
  const bool tells_size = (request.data[0] & 0x01U) != 0;
  if (!is_expedited) {
    const std::size_t announced = tells_size ? canopen::get(request, 4, 4) : 0;
    std::string now;
    if (const std::uint32_t problem = dictionary.read(object, now); problem != kNoAbort) {
      return abort(object, problem);
    }
    transfer_ = Transfer{.object = object, .is_download = true, .toggle = false, .bytes = {}, .announced = announced};
    return frame(0x60, object, 0);
  }
  transfer_.reset();
  const auto its_size = static_cast<std::size_t>(std::max(dictionary.size_bytes(object), 1));
  const std::size_t count = tells_size ? 4U - (request.data[0] >> 2U & 3U) : its_size;
  if (const std::uint32_t problem = dictionary.write(object, bytes_of(request, 4, count)); problem != kNoAbort) {
    return abort(object, problem);
  }
  written = object;
  return frame(0x60, object, 0);
}

CanFrame SdoServer::download_segment(const CanFrame& request, ObjectDictionary& dictionary,
                                     std::optional<Object>& written) {
  Transfer& transfer = *transfer_;
  const Object object = transfer.object;
  const bool toggle = (request.data[0] & kToggle) != 0;
  if (toggle != transfer.toggle) {
    return abort(object, kToggleAbort);
  }
  transfer.bytes += bytes_of(request, 1, kInSegment - (request.data[0] >> 1U & 7U));
  transfer.toggle = !toggle;
  if (transfer.bytes.size() > kTransferMax) {
    return abort(object, kTooLongAbort);
  }
  if ((request.data[0] & 0x01U) != 0) {  // the last one
    const bool is_whole = transfer.announced == 0 || transfer.announced == transfer.bytes.size();
    const std::uint32_t problem = is_whole ? dictionary.write(object, transfer.bytes) : kLengthAbort;
    if (problem != kNoAbort) {
      return abort(object, problem);
    }
    transfer_.reset();
    written = object;
  }
  return frame(toggle ? 0x30 : 0x20, {}, 0);
}

CanFrame SdoServer::begin_upload(const CanFrame& request, const ObjectDictionary& dictionary) {
  const Object object = object_of(request);
  transfer_.reset();
  std::string bytes;
  if (const std::uint32_t problem = dictionary.read(object, bytes); problem != kNoAbort) {
    return abort(object, problem);
  }
  if (bytes.size() > 4) {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    transfer_ = Transfer{.object = object, .is_download = false, .toggle = false, .bytes = std::move(bytes)};
    return frame(0x41, object, size);
  }
  CanFrame reply = frame(static_cast<std::uint8_t>(0x43U | (4U - bytes.size()) << 2U), object, 0);
  std::ranges::copy(bytes, reply.data.begin() + 4);
  return reply;
}

CanFrame SdoServer::upload_segment(const CanFrame& request) {
  Transfer& transfer = *transfer_;
  const bool toggle = (request.data[0] & kToggle) != 0;
  if (toggle != transfer.toggle) {
    return abort(transfer.object, kToggleAbort);
  }
  const std::size_t count = std::min(kInSegment, transfer.bytes.size() - transfer.at);
  const bool is_last = transfer.at + count == transfer.bytes.size();
  CanFrame reply = frame(
      static_cast<std::uint8_t>((toggle ? kToggle : 0U) | (kInSegment - count) << 1U | (is_last ? 1U : 0U)), {}, 0);
  std::copy_n(transfer.bytes.begin() + static_cast<std::ptrdiff_t>(transfer.at), count, reply.data.begin() + 1);
  transfer.at += count;
  transfer.toggle = !toggle;
  if (is_last) {
    transfer_.reset();
  }
  return reply;
}

}  // namespace odoless
