/// From reset to recorded_bus() on a Cortex-M7: vectors, floating point, memory. Armv7-M Architecture Reference Manual, B1.5 and B3.2.20.

#include <cstdint>

#include "firmware/cortex_m/semihosting.hpp"

int recorded_bus();  ///< recorded_bus.cpp; its exit status

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): names of the linker script
extern std::uint32_t __data_begin, __data_end, __data_from, __bss_begin, __bss_end, __stack_top;
using Initialiser = void (*)();
extern Initialiser __init_begin, __init_end;
// NOLINTEND(bugprone-reserved-identifier)

[[noreturn]] void reset() {
    // CP10 and CP11, full access, before the first floating-point instruction.
    *reinterpret_cast<volatile std::uint32_t*>(0xE000'ED88U) = 0xFU << 20U;
    asm volatile("dsb\n isb" ::: "memory");
    const std::uint32_t* from = &__data_from;
    for (std::uint32_t* to = &__data_begin; to != &__data_end;) *to++ = *from++;
    for (std::uint32_t* to = &__bss_begin; to != &__bss_end;) *to++ = 0;
    for (const Initialiser* initialise = &__init_begin; initialise != &__init_end; ++initialise) (*initialise)();
    semihosting::exit(recorded_bus());
}

[[noreturn]] void fault() {
    semihosting::write_text("fault: the processor took an exception\n");
    semihosting::exit(70);
}
}

namespace {

/// Initial stack pointer, then the exceptions 1 to 15. No interrupt is enabled.
struct Vectors {
    const std::uint32_t* stack;
    void (*exceptions[15])();
};

[[gnu::section(".vectors"), gnu::used]] const Vectors kVectors{
    &__stack_top, {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault}};

}  // namespace
