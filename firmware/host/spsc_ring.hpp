/// Lock-free ring between exactly one writing and one reading thread. The writer never waits: items that do not fit are dropped and counted.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace antiskid::host {

/// `Capacity` items, a power of two. Large: do not put it on the stack.
template <typename T, std::size_t Capacity>
class SpscRing {
    static_assert(std::has_single_bit(Capacity), "a power of two");
    static_assert(std::is_trivially_copyable_v<T>, "copied without allocation");
    static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

  public:
    /// Writer only. False: full, the item is lost and counted.
    bool push(const T& item) {
        const std::uint64_t head = head_.load(std::memory_order_relaxed);
        if (head - tail_.load(std::memory_order_acquire) == Capacity) {
            dropped_.fetch_add(1, std::memory_order_relaxed);
            return false;
        }
        items_[head % Capacity] = item;
        head_.store(head + 1, std::memory_order_release);
        return true;
    }

    /// Reader only. False: empty, `item` untouched.
    bool pop(T& item) {
        const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
        if (tail == head_.load(std::memory_order_acquire)) return false;
        item = items_[tail % Capacity];
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }

    /// Items lost since construction; any thread.
    [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

  private:
    static constexpr std::size_t kCacheLine = 64;
    alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};  ///< written by the writer only
    alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};  ///< written by the reader only
    alignas(kCacheLine) std::atomic<std::uint64_t> dropped_{0};
    std::array<T, Capacity> items_{};
};

}  // namespace antiskid::host
