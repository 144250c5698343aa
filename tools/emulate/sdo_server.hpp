#pragma once

#include <optional>
#include <string>

#include "drivers/io/can_frame.hpp"
#include "tools/emulate/object_dictionary.hpp"

namespace odoless {

/// A CANopen node's SDO server: expedited and segmented transfers both ways, one at a time (CiA 301, 7.2.4).
class SdoServer {
 public:
  explicit SdoServer(int node) : node_(node) {}

  /// Forgets the transfer that is under way.
  void reset() { transfer_.reset(); }

  /// The answer to a frame on the client's id; nothing to one that is too short, or that aborts a transfer.
  /// `written` is what has been changed by it, if anything.
  [[nodiscard]] std::optional<CanFrame> answer(const CanFrame& request, ObjectDictionary& dictionary,
                                               std::optional<canopen::Object>& written);

 private:
  struct Transfer {
    canopen::Object object;
    bool is_download = false;
    bool toggle = false;
    std::string bytes;          ///< received, or to be sent
    std::size_t at = 0;         ///< how many of these are sent
    std::size_t announced = 0;  ///< 0: their number wasn't told
  };

  [[nodiscard]] CanFrame frame(std::uint8_t command, canopen::Object object, std::uint32_t value) const;
  [[nodiscard]] CanFrame abort(canopen::Object object, std::uint32_t code);
  [[nodiscard]] CanFrame begin_download(const CanFrame& request, ObjectDictionary& dictionary,
                                        std::optional<canopen::Object>& written);
  [[nodiscard]] CanFrame begin_upload(const CanFrame& request, const ObjectDictionary& dictionary);
  [[nodiscard]] CanFrame download_segment(const CanFrame& request, ObjectDictionary& dictionary,
                                          std::optional<canopen::Object>& written);
  [[nodiscard]] CanFrame upload_segment(const CanFrame& request);

  int node_;
  std::optional<Transfer> transfer_;
};

}  // namespace odoless
