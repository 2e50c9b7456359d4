/// One step of several wheels at once, in vector code if the processor has it. The results have the same bits as those of Wheel.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include "plant_sim/model/wheel_step.hpp"

namespace plant {

/// A struct of doubles for each of several lanes, stored member by member as vector code needs it.
template <typename Struct, std::size_t kLanes>
class Lanes {
  public:
    [[gnu::always_inline]] inline Struct operator[](std::size_t lane) const { return get(lane, kAll); }
    [[gnu::always_inline]] inline void set(std::size_t lane, const Struct& value) { put(lane, value, kAll); }

  private:
    static constexpr std::size_t kMembers = sizeof(Struct) / sizeof(double);
    static constexpr std::make_index_sequence<kMembers> kAll{};
    static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) == kMembers * sizeof(double));

    // Member by member and unrolled: a copy of the whole would keep the loop over the lanes from becoming vector code.
    template <std::size_t... kMember>
    [[gnu::always_inline]] inline Struct get(std::size_t lane, std::index_sequence<kMember...> /*all*/) const {
        Struct value;
        auto* bytes = reinterpret_cast<std::byte*>(&value);
        (std::memcpy(bytes + kMember * sizeof(double), &columns_[kMember][lane], sizeof(double)), ...);
        return value;
    }
    template <std::size_t... kMember>
    [[gnu::always_inline]] inline void put(std::size_t lane, const Struct& value, std::index_sequence<kMember...> /*all*/) {
        const auto* bytes = reinterpret_cast<const std::byte*>(&value);
        (std::memcpy(&columns_[kMember][lane], bytes + kMember * sizeof(double), sizeof(double)), ...);
    }

    alignas(64) std::array<std::array<double, kLanes>, kMembers> columns_{};
};

struct WheelLanes {
    static constexpr std::size_t kLanes = 8;

    /// Initial state and inputs of a step.
    struct Input {
        double v_mps = 0.0, omega_radps = 0.0;
        PressureArc pressure;
        LoadArc load;
        double h = 0.0;
    };

    Lanes<wheel_step::Law, kLanes> laws;
    Lanes<Input, kLanes> inputs;
    Lanes<wheel_step::Step, kLanes> steps;

    /// Instruction sets for the vector code; 64-bit x86 always has `baseline`. The results' bits do not depend on the set.
    enum class Instructions { baseline, avx2, avx512 };
    [[nodiscard]] static bool has(Instructions instructions);

    /// Computes `steps` from `inputs` with the widest instructions of this machine.
    void turn();
    /// The same with `instructions`, which has() must confirm.
    void turn(Instructions instructions);
};

}  // namespace plant
