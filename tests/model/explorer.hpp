#pragma once

#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/model/execution.hpp"
#include "tests/model/fiber.hpp"
#include "tests/model/plain_memory.hpp"

namespace odoless::model {

/// Where an atomic operation stands in a source.
struct Site {
  std::string_view file;
  int line = 0;
  std::string_view function;
  /// As a default argument: where that function is called.
  static Site here(const char* file = __builtin_FILE(), int line = __builtin_LINE(),
                   const char* function = __builtin_FUNCTION()) {
    return {file, line, function};
  }
  friend auto operator<=>(const Site&, const Site&) = default;
};

/// One way in which an operation could be weaker by a step.
enum class Weakening { kNoAcquire, kNoRelease, kNoAcquireWhereItFails, kLoadAndStore, kNoTotalOrder };

struct Mutant {
  Site site;
  Weakening weakening;
  friend auto operator<=>(const Mutant&, const Mutant&) = default;
};

/// What a few threads do with one structure, and what has to hold. Made anew for each execution; all that its threads
/// share besides atomics is `Plain` or `touch`ed, and nothing that a thread does depends on anything else.
class Scenario {
 public:
  Scenario() = default;
  virtual ~Scenario() = default;
  Scenario(const Scenario&) = delete;
  Scenario& operator=(const Scenario&) = delete;

  virtual void run(std::size_t thread) = 0;
  /// On a thread that sees all that the others did. What goes on until something is so belongs here.
  virtual void look_at_the_end() {}
};

struct Program {
  const char* name;
  std::size_t threads;
  std::unique_ptr<Scenario> (*make)();
};

struct Verdict {
  std::uint64_t executions = 0;
  std::string problem;  ///< what does not hold in the last of them; empty: all holds in every one
};

/// Runs a program in every execution that the C++ memory model allows, but for those in which a read has its value from
/// a write that depends on it. Atomic operations and plain memory of the program come here; one explorer at a time.
class Explorer {
 public:
  explicit Explorer(std::optional<Mutant> mutant = std::nullopt) : mutant_(mutant) {}

  [[nodiscard]] Verdict explore(const Program& program);
  /// Of all operations that were done.
  [[nodiscard]] const std::set<Mutant>& mutants() const { return mutants_; }

  /// Of the exploration that is under way.
  static Explorer& current();

  [[nodiscard]] std::uint8_t make_place(std::uint64_t value);
  std::uint64_t load(std::uint8_t place, std::memory_order order, Site site);
  void store(std::uint8_t place, std::uint64_t value, std::memory_order order, Site site);
  using Change = std::function<std::uint64_t(std::uint64_t)>;
  std::uint64_t exchange(std::uint8_t place, const Change& change, std::memory_order order, Site site);
  /// What was there: the value is new if that is `expected`.
  struct Orders {
    std::memory_order success;
    std::memory_order failure;
  };
  std::uint64_t compare_exchange(std::uint8_t place, std::uint64_t expected, std::uint64_t value, Orders orders,
                                 Site site);

  void touch(const void* begin, std::size_t size_bytes, bool writes);
  /// Ends the exploration. Does not return.
  [[noreturn]] void fail(const std::string& problem);

 private:
  static constexpr std::size_t kMaxEvents = 200;  ///< of a thread: its loops have to end

  void run_once(const Program& program);
  void replay();
  [[nodiscard]] bool has(Weakening weakening, Site site);
  [[nodiscard]] bool acquires(std::memory_order order, Site site, Weakening without);
  [[nodiscard]] bool releases(std::memory_order order, Site site);
  void note_total_order(std::memory_order order, Site site);
  [[nodiscard]] const Event* replayed(std::uint8_t place, bool is_write);
  std::uint64_t read(std::uint8_t place, const Reading& reading);
  void write(std::uint8_t place, const Writing& writing);
  [[noreturn]] void leave();
  [[nodiscard]] std::string trace() const;

  std::optional<Mutant> mutant_;
  std::set<Mutant> mutants_;
  std::vector<Execution> pending_;
  Execution execution_;
  std::unique_ptr<Scenario> scenario_;
  PlainMemory memory_;
  std::array<Fiber, kThreads> fibers_;
  std::array<std::size_t, kThreads> done_{};          ///< events of each thread in this run
  std::size_t thread_ = kThreads;                     ///< that runs; kThreads: none
  std::map<std::uint8_t, std::uint64_t> afterwards_;  ///< what destructors write
  std::uint8_t next_place_ = 0;
  bool is_replaying_ = false;
  bool is_left_ = false;  ///< this run goes no further
  std::string problem_;
};

/// For a scenario: what has to hold.
inline void require(bool holds, const char* what) {
  if (!holds) {
    Explorer::current().fail(what);
  }
}

}  // namespace odoless::model
