/// End-to-end protection of a frame: alive counter and CRC-8, after AUTOSAR E2E profile 11 variant A (FO PRS
/// E2EProtocol).
///
/// As there: counter 0 to 14, CRC-8 over the 16-bit data ID (low byte first) and then the payload without the
/// CRC's own byte; the data ID itself is not sent, so a frame sent under the wrong identifier fails the check. Unlike there: the CRC is the plain
/// CRC-8/SAE-J1850 (profile 11 starts it from 00 and does not invert it), and both fields may sit anywhere. Protection `counter` has no CRC, and its
/// counter uses the whole field (modulo 2^bits).
///
/// Sequence rule: the first frame is accepted. A later frame is accepted if its counter advanced by delta = 1 to max_delta; delta - 1 frames are
/// counted as lost. A repeat (delta 0) or a larger step is refused. The counter of a refused larger step becomes the new reference, so that a
/// restarted sender or a long gap costs exactly one more frame. A repeat or a wrong CRC leaves the reference unchanged. Freestanding.
#pragma once

#include <cstdint>

#include "firmware/can/frame.hpp"
#include "firmware/can/signal.hpp"

namespace antiskid::can {

enum class Protection : std::uint8_t { none, counter, counter_crc };

struct E2e {
    Protection protection = Protection::none;
    Signal counter;
    std::uint8_t crc_byte = 0;
    std::uint16_t data_id = 0;
    std::uint16_t counter_modulo = 15;  ///< values 0 to counter_modulo - 1 are valid
    std::uint8_t max_delta = 1;         ///< 1 to counter_modulo / 2, so that a step back cannot look like a step forward
    bool ordered = true;                ///< false: the counter is not checked (a late or repeated emergency stop must still act)
};

/// The CRC of this payload, to be stored at `config.crc_byte`.
[[nodiscard]] std::uint8_t e2e_crc(const Frame& frame, const E2e& config);

enum class E2eResult : std::uint8_t {
    ok,
    wrong_crc,
    repeated,
    wrong_sequence,  ///< counter moved by more than max_delta, went back, or has a value that is never sent
};

/// Protects one sent message: writes counter and CRC, then advances the counter.
class E2eSender {
  public:
    /// The counter and CRC fields of `payload` must be zero.
    void protect(const E2e& config, Payload payload, Frame& frame);

  private:
    std::uint16_t counter_ = 0;
};

/// Checks one received message.
class E2eChecker {
  public:
    /// Increases `lost` by the number of frames that the counter shows to be missing before an accepted frame.
    [[nodiscard]] E2eResult check(const E2e& config, const Frame& frame, const Payload& payload, std::uint32_t& lost);

  private:
    std::uint16_t last_ = 0;
    bool synchronised_ = false;
};

}  // namespace antiskid::can
