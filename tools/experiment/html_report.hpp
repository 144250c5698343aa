#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tools/experiment/campaign.hpp"

namespace odoless {

/// One HTML file with every claim and every figure inside, which needs nothing beside it and no network.
/// @param out  The campaign's folder, for the pictures.
[[nodiscard]] std::string html_report(std::span<const Record> records, const std::filesystem::path& out);

}  // namespace odoless
