#include "firmware/can/e2e.hpp"

#include "firmware/can/crc8.hpp"

namespace antiskid::can {

std::uint8_t e2e_crc(const Frame& frame, const E2e& config) {
    Crc8 crc;
    crc.add(static_cast<std::uint8_t>(config.data_id & 0xFFU));
    crc.add(static_cast<std::uint8_t>(config.data_id >> 8U));
    for (std::size_t i = 0; i < frame.length; ++i) {
        if (i != config.crc_byte) crc.add(frame.data[i]);
    }
    return crc.value();
}

void E2eSender::protect(const E2e& config, Payload payload, Frame& frame) {
    if (config.protection != Protection::none) {
        payload.write(config.counter, counter_);
        counter_ = static_cast<std::uint16_t>((counter_ + 1U) % config.counter_modulo);
    }
    frame.data = payload.bytes();
    if (config.protection == Protection::counter_crc) frame.data[config.crc_byte] = e2e_crc(frame, config);
}

E2eResult E2eChecker::check(const E2e& config, const Frame& frame, const Payload& payload, std::uint32_t& lost) {
    if (config.protection == Protection::none) return E2eResult::ok;
    if (config.protection == Protection::counter_crc && frame.data[config.crc_byte] != e2e_crc(frame, config)) {
        return E2eResult::wrong_crc;
    }
    if (!config.ordered) return E2eResult::ok;

    const auto counter = static_cast<std::uint16_t>(payload.read(config.counter));
    if (counter >= config.counter_modulo) return E2eResult::wrong_sequence;
    if (!synchronised_) {
        synchronised_ = true;
        last_ = counter;
        return E2eResult::ok;
    }
    const std::uint32_t delta = (counter + std::uint32_t{config.counter_modulo} - last_) % config.counter_modulo;
    if (delta == 0) return E2eResult::repeated;
    last_ = counter;
    if (delta > config.max_delta) return E2eResult::wrong_sequence;
    lost += delta - 1U;
    return E2eResult::ok;
}

}  // namespace antiskid::can
