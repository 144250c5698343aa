#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless campaign --runs N`: seeded faults whose truth is known, against what the daemon says of its pose.
void add_campaign(CLI::App& app);

}  // namespace odoless
