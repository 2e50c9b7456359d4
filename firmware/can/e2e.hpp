/// End-to-end protection of a frame: alive counter and CRC-8, after AUTOSAR E2E profile 11 variant A (FO PRS
/// E2EProtocol).
///
/// As there: counter 0 to 14, CRC-8 over the 16-bit data ID (low byte first) and then the payload without the
/// CRC's own byte; the data ID itself is not sent, so a frame under a foreign identifier fails. Unlike there:
/// the CRC is the plain CRC-8/SAE-J1850 (profile 11 starts it from 00 and does not invert it), and both
/// fields may sit anywhere. Protection `counter` has no CRC, and its counter uses the whole field (modulo
/// 2^bits).
///
/// Sequence rule: the first frame is accepted. Later ones when the counter moved by 1 to max_delta (delta - 1
/// are counted as lost). A repeat (delta 0) or a larger step is refused. A refused larger step becomes the
/// new reference, so a sender that restarts, or a gap that is too long, costs exactly one frame more; a
/// repeat and a frame with a wrong CRC change nothing. Freestanding.
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
    std::uint8_t max_delta = 1;         ///< 1 to counter_modulo / 2, so that a step back is never taken for a step on
    bool ordered = true;                ///< false: the counter is not checked (a stop that comes late or twice must still stop)
};

/// The CRC that belongs into `config.crc_byte` of this payload.
[[nodiscard]] std::uint8_t e2e_crc(const Frame& frame, const E2e& config);

enum class E2eResult : std::uint8_t {
    ok,
    wrong_crc,
    repeated,
    wrong_sequence,  ///< counter moved by more than max_delta, went back, or has a value that is never sent
};

/// The sending end of one message. Writes the counter into the payload, then the CRC, and advances the
/// counter.
class E2eSender {
  public:
    /// `payload` has zeros where counter and CRC go.
    void protect(const E2e& config, Payload payload, Frame& frame);

  private:
    std::uint16_t counter_ = 0;
};

/// The receiving end of one message.
class E2eChecker {
  public:
    /// `lost` is increased by the frames that the counter says are missing before an accepted one.
    [[nodiscard]] E2eResult check(const E2e& config, const Frame& frame, const Payload& payload, std::uint32_t& lost);

  private:
    std::uint16_t last_ = 0;
    bool synchronised_ = false;
};

}  // namespace antiskid::can
