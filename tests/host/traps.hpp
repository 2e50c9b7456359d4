/// Traps on everything that the real-time thread must not do. Linked into the program that wants them, they stand in front of the C
/// library's functions, for the program and for every shared library in it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace host_test::traps {

enum class Call : std::uint8_t { allocate, release, lock, wait_condition, write, print, throw_exception, sleep };
inline constexpr std::size_t kCalls = 8;
inline constexpr std::array<std::string_view, kCalls> kNames{"allocate", "release",         "lock", "wait_condition", "write",
                                                             "print",    "throw_exception", "sleep"};

/// While one lives, this thread's forbidden calls are counted, and then carried out.
class Armed {
  public:
    Armed();
    ~Armed();
    Armed(const Armed&) = delete;
    Armed& operator=(const Armed&) = delete;
};

/// Inside an Armed: what happens while one lives is not counted (the test's own work within the loop).
class Disarmed {
  public:
    Disarmed();
    ~Disarmed();
    Disarmed(const Disarmed&) = delete;
    Disarmed& operator=(const Disarmed&) = delete;

  private:
    bool before_;
};

[[nodiscard]] std::uint64_t caught(Call call);
[[nodiscard]] std::uint64_t caught();
void clear();

}  // namespace host_test::traps
