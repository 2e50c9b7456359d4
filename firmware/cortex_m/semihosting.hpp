/// Access to the host's files and exit status by semihosting breakpoints. Source: Arm, Semihosting for AArch32 and AArch64, release 2022Q1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace semihosting {

namespace detail {

inline std::intptr_t call(std::uint32_t operation, const void* parameters) {
    register std::uint32_t r0 asm("r0") = operation;
    register const void* r1 asm("r1") = parameters;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return static_cast<std::intptr_t>(r0);
}

}  // namespace detail

enum class Mode : std::uint32_t { read_binary = 1, write_binary = 5 };

/// A handle, or -1.
inline std::intptr_t open(const char* name, std::size_t length, Mode mode) {
    const std::array<std::uintptr_t, 3> p{reinterpret_cast<std::uintptr_t>(name), static_cast<std::uintptr_t>(mode), length};
    return detail::call(0x01, p.data());
}

/// Returns the number of bytes not written; 0 is success.
inline std::size_t write(std::intptr_t handle, const void* data, std::size_t size) {
    const std::array<std::uintptr_t, 3> p{static_cast<std::uintptr_t>(handle), reinterpret_cast<std::uintptr_t>(data), size};
    return static_cast<std::size_t>(detail::call(0x05, p.data()));
}

/// Returns the number of bytes read; 0 at the end of the file.
inline std::size_t read(std::intptr_t handle, void* data, std::size_t size) {
    const std::array<std::uintptr_t, 3> p{static_cast<std::uintptr_t>(handle), reinterpret_cast<std::uintptr_t>(data), size};
    return size - static_cast<std::size_t>(detail::call(0x06, p.data()));
}

inline void close(std::intptr_t handle) {
    const auto p = static_cast<std::uintptr_t>(handle);
    detail::call(0x02, &p);
}

/// Writes to the host's console.
inline void write_text(const char* text) {
    detail::call(0x04, text);
}

/// Copies the command line, zero-terminated, to `buffer`; returns its length, 0 if it does not fit.
inline std::size_t command_line(char* buffer, std::size_t size) {
    std::array<std::uintptr_t, 2> p{reinterpret_cast<std::uintptr_t>(buffer), size};
    return detail::call(0x15, p.data()) == 0 ? p[1] : 0;
}

[[noreturn]] inline void exit(int status) {
    constexpr std::uintptr_t kApplicationExit = 0x20026;
    const std::array<std::uintptr_t, 2> p{kApplicationExit, static_cast<std::uintptr_t>(status)};
    for (;;) detail::call(0x20, p.data());
}

}  // namespace semihosting
