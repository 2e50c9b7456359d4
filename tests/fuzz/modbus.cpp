// What a PLC answers, and what a client asks of our server: an answer that is accepted is as long as its reader takes it to be.
#include <vector>

#include "rig_bridge/modbus/confirmation.hpp"
#include "rig_bridge/modbus/request.hpp"
#include "rig_bridge/rig/register_map.hpp"
#include "tests/fuzz/input.hpp"

namespace {

const rig::RegisterMap& map() {
    static const rig::RegisterMap shipped = rig::load_register_map("config/registers.toml");
    return shipped;
}

void judge_answer(fuzz::Input& input) {
    const auto address = input.take<std::uint16_t>();
    const auto count = static_cast<std::uint16_t>(1U + input.take<std::uint8_t>() % 123U);
    const bool writes = (input.take<std::uint8_t>() & 1U) != 0;
    const std::vector<std::uint16_t> words(count, 0x1234);
    const std::vector<std::uint8_t> request = writes ? rig::modbus::write_request(address, words) : rig::modbus::read_request(4, address, count);
    const auto answer = input.rest();
    if (rig::modbus::tcp_header_fault(address, 1, answer).empty()) fuzz::require(answer.size() > 7);
    if (answer.empty()) return;
    const unsigned exception = rig::modbus::exception_of(request, answer);
    const bool fits = rig::modbus::answer_fault(request, answer).empty();
    fuzz::require(!(exception != 0 && fits));
    if (fits) fuzz::require(answer.size() == (writes ? 5U : 2U + 2U * count));
}

void judge_request(const fuzz::Input& input) {
    static const rig::modbus::RegisterSet inputs(map().measured);
    static const rig::modbus::RegisterSet holdings(map().commanded);
    const auto bytes = input.rest();
    const rig::modbus::TcpFrame frame = rig::modbus::tcp_frame(bytes);
    if (frame.state != rig::modbus::FrameState::whole) return;
    fuzz::require(frame.length > rig::modbus::kTcpHeader && frame.length <= bytes.size() && frame.length <= rig::modbus::kTcpMax);
    static_cast<void>(rig::modbus::judge(bytes.subspan(rig::modbus::kTcpHeader, frame.length - rig::modbus::kTcpHeader), inputs, holdings));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input input(data, size);
    if ((input.take<std::uint8_t>() & 1U) != 0) {
        judge_answer(input);
    } else {
        judge_request(input);
    }
    return 0;
}
