/// The bytes of a MATLAB element in order, as they lie in the file or inflated on the way.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>

namespace rig::replay {

class MatBytes {
  public:
    virtual ~MatBytes() = default;
    /// False when there are fewer left; `out` is then of no use.
    [[nodiscard]] virtual bool take(std::span<unsigned char> out) = 0;
    [[nodiscard]] virtual bool skip(std::uint64_t count) = 0;
};

class PlainBytes final : public MatBytes {
  public:
    explicit PlainBytes(std::span<const unsigned char> bytes) : left_(bytes) {}
    [[nodiscard]] bool take(std::span<unsigned char> out) override;
    [[nodiscard]] bool skip(std::uint64_t count) override;

  private:
    std::span<const unsigned char> left_;
};

/// Inflates into what is asked for: of what is skipped nothing is kept, however long it is.
class InflatedBytes final : public MatBytes {
  public:
    explicit InflatedBytes(std::span<const unsigned char> compressed);
    InflatedBytes(const InflatedBytes&) = delete;
    InflatedBytes& operator=(const InflatedBytes&) = delete;
    ~InflatedBytes() override;
    [[nodiscard]] bool take(std::span<unsigned char> out) override;
    [[nodiscard]] bool skip(std::uint64_t count) override;

  private:
    z_stream stream_{};
    bool ready_ = false;
    bool more_ = false;
};

}  // namespace rig::replay
