#pragma once

#include <optional>
#include <vector>

#include "tools/emulate/object_dictionary.hpp"

namespace odoless {

/// The frame of transmit PDO `pdo` (from 0), as it is mapped; nothing where it is not valid or not for each SYNC.
[[nodiscard]] std::optional<CanFrame> transmit_pdo(const ObjectDictionary& dictionary, int pdo);

/// Writes what `frame` carries, if it is receive PDO `pdo` (from 0). @return the objects that were written.
[[nodiscard]] std::vector<canopen::Object> take_received_pdo(ObjectDictionary& dictionary, int pdo,
                                                             const CanFrame& frame);

}  // namespace odoless
