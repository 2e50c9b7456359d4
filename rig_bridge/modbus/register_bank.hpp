/// The registers behind a server: requests on one side, the plant on the other. The plant never waits for a request to
/// be answered, only for copies.
#pragma once

#include <modbus/modbus.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include "rig_bridge/modbus/request.hpp"
#include "rig_bridge/modbus/server.hpp"
#include "rig_bridge/rig/register_codec.hpp"

namespace rig::modbus {

class RegisterBank {
  public:
    explicit RegisterBank(const RegisterMap& map);

    // The plant's thread.
    PlcCommands exchange(const MeasuredValues& measured);
    [[nodiscard]] std::uint16_t bridge_turn() const { return bridge_turn_; }

    // The server's thread.

    /// Seconds for which the request now at hand is to be left lying: a hang that was asked for before. Asked once.
    [[nodiscard]] double take_hang();
    enum class Answer : std::uint8_t { given, exception, failed };
    /// Answers a whole request (`header` bytes before the function code, `checksum` after the PDU) through `context`;
    /// `silent`: a broadcast, which gets no exception either.
    Answer answer(modbus_t* context, std::span<const std::uint8_t> adu, std::size_t header, std::size_t checksum, bool silent);

  private:
    void fetch_inputs();
    void publish();

    struct MappingFree {
        void operator()(modbus_mapping_t* mapping) const { modbus_mapping_free(mapping); }
    };

    RegisterMap map_;
    RegisterSet inputs_there_;
    RegisterSet holdings_there_;
    RegisterImage holdings_;  // of the server's thread, as `mapping_` is
    std::unique_ptr<modbus_mapping_t, MappingFree> mapping_;

    std::atomic<std::uint16_t> bridge_turn_{0};

    std::mutex mutex_;  // guards what follows, held for copies only
    RegisterImage inputs_;
    PlcCommands commands_;
};

}  // namespace rig::modbus
