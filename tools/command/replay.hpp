#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless replay LOG --out DIR`: a log through the whole pipeline: trajectory, map, matches, summary.
void add_replay(CLI::App& app);

/// `odoless match LOG --out DIR`: pairwise matching alone.
void add_match(CLI::App& app);

}  // namespace odoless
