#include "rig_bridge/modbus/register_bank.hpp"

#include <algorithm>
#include <new>
#include <vector>

namespace rig::modbus {
namespace {

std::vector<Field> holding_fields(const RegisterMap& map) {
    std::vector<Field> fields(map.commanded.begin(), map.commanded.end());
    fields.push_back(map.open_interlocks);
    fields.push_back(map.hang_s);
    if (map.bridge_turn) fields.push_back(*map.bridge_turn);
    return fields;
}

modbus_mapping_t* new_mapping(const RegisterImage& holdings, const RegisterImage& inputs) {
    auto* mapping = modbus_mapping_new_start_address(0, 0, 0, 0, holdings.first(), static_cast<unsigned>(holdings.words().size()), inputs.first(),
                                                     static_cast<unsigned>(inputs.words().size()));
    if (mapping == nullptr) throw std::bad_alloc();
    return mapping;
}

}  // namespace

RegisterBank::RegisterBank(const RegisterMap& map)
    : map_(map),
      inputs_there_(map.measured),
      holdings_there_(holding_fields(map)),
      holdings_(holding_fields(map), map.word_order),
      inputs_(map.measured, map.word_order) {
    mapping_.reset(new_mapping(holdings_, inputs_));
    for (const Field& field : holding_fields(map)) static_cast<void>(holdings_.write(field, 0.0));
    const auto words = holdings_.words();
    std::copy(words.begin(), words.end(), mapping_->tab_registers);
    write_inputs();
}

void RegisterBank::write_inputs() {
    write(map_, inputs_, measured_);
    static_cast<void>(inputs_.write(map_.field(Measured::map_version), map_.version));
}

PlcCommands RegisterBank::exchange(const MeasuredValues& measured) {
    const std::lock_guard lock(mutex_);
    if (measured != measured_) {  // it changes with each scan of the PLC, not with each period
        measured_ = measured;
        write_inputs();
    }
    return commands_;
}

void RegisterBank::fetch_inputs() {
    const std::lock_guard lock(mutex_);
    const auto words = inputs_.words();
    std::copy(words.begin(), words.end(), mapping_->tab_input_registers);
}

void RegisterBank::publish() {
    const auto words = holdings_.words();
    std::copy_n(mapping_->tab_registers, words.size(), words.begin());
    const CommandedValues now = read_commanded(map_, holdings_);
    const auto open = static_cast<unsigned>(holdings_.read(map_.open_interlocks).value);
    const double commit = at(now, Commanded::commit);

    {
        const std::lock_guard lock(mutex_);
        if (commit != 0.0 && commit != at(commands_.commanded, Commanded::commit)) commands_.commanded = now;
        at(commands_.commanded, Commanded::bridge_watchdog) = at(now, Commanded::bridge_watchdog);
        commands_.open_interlocks = interlocks_from_register(map_, open);
    }
    // After all registers written before it.
    if (map_.bridge_turn) bridge_turn_ = static_cast<std::uint16_t>(holdings_.read(*map_.bridge_turn).value);
}

double RegisterBank::take_hang() {
    const auto words = holdings_.words();
    std::copy_n(mapping_->tab_registers, words.size(), words.begin());
    const double seconds = holdings_.read(map_.hang_s).value;
    if (seconds > 0.0) {
        static_cast<void>(holdings_.write(map_.hang_s, 0.0));
        std::copy(words.begin(), words.end(), mapping_->tab_registers);
    }
    return std::clamp(seconds, 0.0, map_.hang_s.max);
}

RegisterBank::Answer RegisterBank::answer(modbus_t* context, std::span<const std::uint8_t> adu, std::size_t header, std::size_t checksum,
                                          bool silent) {
    const auto pdu = adu.subspan(header, adu.size() - header - checksum);
    const Exception exception = judge(pdu, inputs_there_, holdings_there_);
    if (exception != Exception::none) {
        if (!silent && modbus_reply_exception(context, adu.data(), static_cast<unsigned>(exception)) < 0) return Answer::failed;
        return Answer::exception;
    }
    fetch_inputs();
    const int sent = modbus_reply(context, adu.data(), static_cast<int>(adu.size()), mapping_.get());
    publish();
    return sent < 0 ? Answer::failed : Answer::given;
}

}  // namespace rig::modbus
