#pragma once

#include <span>

#include "tests/model/explorer.hpp"

namespace odoless::model {

/// What is done with each structure of the product.
[[nodiscard]] std::span<const Program> programs();

}  // namespace odoless::model
