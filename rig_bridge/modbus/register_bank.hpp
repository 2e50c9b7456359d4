/// The registers of a server, shared by the server's and the plant's thread. The plant waits only for copies, never for the answer to a request.
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

    /// Seconds by which the answer to the present request is to be delayed, as commanded by the register `hang_s`; 0 at the next call.
    [[nodiscard]] double take_hang();
    enum class Answer : std::uint8_t { given, exception, failed };
    /// Answers a whole request (`header` bytes before the function code, `checksum` after the PDU) through `context`;
    /// `silent`: a broadcast, which gets no exception either.
    Answer answer(modbus_t* context, std::span<const std::uint8_t> adu, std::size_t header, std::size_t checksum, bool silent);

  private:
    void write_inputs();
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

    std::mutex mutex_;      // guards what follows, held for copies only
    RegisterImage inputs_;  // of measured_
    MeasuredValues measured_{};
    PlcCommands commands_;
};

}  // namespace rig::modbus
