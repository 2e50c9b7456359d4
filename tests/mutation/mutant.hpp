/// What rewritten sources call at each site: the operation itself, or its mutant when that one's number is the active one.
/// The environment says which is active (MUTANT) and where the numbers that were met are written at the end (MUTANTS_MET).
#pragma once

#include <cstdio>
#include <cstdlib>
#include <type_traits>
#include <utility>

namespace mutant {

inline constexpr int kMax = 16384;  // as MOST of mutate.py
inline int active = 0;
inline unsigned char met[kMax] = {};

// Before any other initialisation: constants of the program are sites too.
[[gnu::constructor(101)]] static void activate() {
    if (const char* const number = std::getenv("MUTANT")) active = std::atoi(number);
}
[[gnu::destructor(101)]] static void report() {
    const char* const path = std::getenv("MUTANTS_MET");
    std::FILE* const file = path != nullptr ? std::fopen(path, "wb") : nullptr;
    if (file == nullptr) return;
    std::fwrite(met, 1, sizeof met, file);
    std::fclose(file);
}

/// Whether mutant `number` is active; never in what is computed at compile time.
[[gnu::always_inline]] constexpr bool on(int number) {
    if (std::is_constant_evaluated()) return false;
    met[number] = 1;
    return number == active;
}

/// Keeps the compiler from computing an initial value by itself.
template <typename T>
T at_start(T value) {
    return value;
}

template <int Number, typename T>
[[gnu::always_inline]] constexpr bool flip(T&& value) {
    return static_cast<bool>(std::forward<T>(value)) != on(Number);
}

// Comparisons of order have a second mutant, the negation.
#define MUTANT_ORDER(name, op, other)                                    \
    template <int Number, typename A, typename B>                        \
    [[gnu::always_inline]] constexpr bool name(const A& a, const B& b) { \
        if (on(Number)) return a other b;                                \
        return static_cast<bool>(a op b) != on(Number + 1);              \
    }
MUTANT_ORDER(less, <, <=)
MUTANT_ORDER(less_equal, <=, <)
MUTANT_ORDER(greater, >, >=)
MUTANT_ORDER(greater_equal, >=, >)
#undef MUTANT_ORDER

template <int Number, typename A, typename B>
[[gnu::always_inline]] constexpr bool equal(const A& a, const B& b) {
    return static_cast<bool>(a == b) != on(Number);
}
template <int Number, typename A, typename B>
[[gnu::always_inline]] constexpr bool not_equal(const A& a, const B& b) {
    return static_cast<bool>(a != b) != on(Number);
}

// Where the types have no such other operator (strings have no minus), nothing comes out. Nothing is divided by zero.
#define MUTANT_BINARY(name, op, other, divides)                                                          \
    template <int Number, typename A, typename B>                                                        \
    [[gnu::always_inline]] constexpr auto name(const A& a, const B& b)->std::decay_t<decltype(a op b)> { \
        using Result = std::decay_t<decltype(a op b)>;                                                   \
        if (on(Number)) {                                                                                \
            if constexpr (requires { Result(a other b); }) {                                             \
                if constexpr ((divides) && std::is_integral_v<B>) {                                      \
                    if (b == 0) return Result{};                                                         \
                }                                                                                        \
                return Result(a other b);                                                                \
            } else {                                                                                     \
                return Result{};                                                                         \
            }                                                                                            \
        }                                                                                                \
        return a op b;                                                                                   \
    }
MUTANT_BINARY(plus, +, -, false)
MUTANT_BINARY(minus, -, +, false)
MUTANT_BINARY(times, *, /, true)
MUTANT_BINARY(over, /, *, false)
MUTANT_BINARY(modulo, %, *, false)
MUTANT_BINARY(bit_and, &, |, false)
MUTANT_BINARY(bit_or, |, &, false)
MUTANT_BINARY(bit_xor, ^, &, false)
MUTANT_BINARY(shift_left, <<, >>, false)
MUTANT_BINARY(shift_right, >>, <<, false)
#undef MUTANT_BINARY

#define MUTANT_COMPOUND(name, op, other)                         \
    template <int Number, typename A, typename B>                \
    [[gnu::always_inline]] constexpr A& name(A& a, const B& b) { \
        if (on(Number)) {                                        \
            if constexpr (requires { a other b; }) {             \
                a other b;                                       \
            }                                                    \
            return a;                                            \
        }                                                        \
        a op b;                                                  \
        return a;                                                \
    }
MUTANT_COMPOUND(add, +=, -=)
MUTANT_COMPOUND(subtract, -=, +=)
MUTANT_COMPOUND(include, |=, &=)
MUTANT_COMPOUND(toggle, ^=, |=)
#undef MUTANT_COMPOUND

template <int Number, int By, typename T>
[[gnu::always_inline]] constexpr T& step(T& value) {
    ((By > 0) != on(Number)) ? ++value : --value;
    return value;
}
template <int Number, int By, typename T>
[[gnu::always_inline]] constexpr T step_after(T& value) {
    const T before = value;
    step<Number, By>(value);
    return before;
}

template <int Number, typename T>
[[gnu::always_inline]] constexpr auto opposite(const T& value) -> std::decay_t<decltype(-value)> {
    return on(Number) ? std::decay_t<decltype(-value)>(value) : -value;
}

/// What a function returns that returns nothing of worth: zero, no, an empty structure.
struct Nothing {
    template <typename T>
    constexpr operator T() const {  // NOLINT(google-explicit-constructor): it is what is returned in place of a T
        if constexpr (std::is_default_constructible_v<T>) {
            return T{};
        } else {
            std::abort();
        }
    }
};

/// The next whole number, twice the fraction, one for none, the other truth.
template <int Number, typename T>
[[gnu::always_inline]] constexpr T constant(T value) {
    if (!on(Number)) return value;
    if constexpr (std::is_same_v<T, bool>) {
        return !value;
    } else if constexpr (std::is_floating_point_v<T>) {
        return value == T(0) ? T(1) : T(2) * value;
    } else {
        return static_cast<T>(value + T(1));
    }
}

}  // namespace mutant
