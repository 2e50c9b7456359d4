#include "firmware/can/message_binder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "firmware/host/settings/near_miss.hpp"

namespace antiskid::can {

namespace {

constexpr std::string_view kSignalKey = "signal";
constexpr std::uint32_t kWidestPhysical = 32;
constexpr std::uint32_t kWidestClock = 48;
constexpr std::uint16_t kProfileCounterModulo = 15;
constexpr double kMinRollOver_ns = 200e6;  // twice the 100 ms below which an encoder is taken to stand still

template <typename Items>
std::string suggestion(std::string_view word, const Items& items) {
    std::vector<std::string_view> names;
    names.reserve(items.size());
    for (const auto& item : items) names.push_back(item.name);
    const std::string_view nearest = settings::nearest(word, names);
    if (nearest.empty()) return {};
    return "; did you mean '" + std::string(nearest) + "'?";
}

std::string bits(std::uint32_t count) {
    return std::to_string(count) + (count == 1 ? " bit" : " bits");
}

/// Position of the field's least significant bit in the payload word of its byte order; none when it sticks
/// out of the message.
std::optional<std::uint32_t> shift_of(const DbcSignal& signal, std::uint32_t length) {
    if (!signal.big_endian) {
        return signal.start + signal.bits <= 8 * length ? std::optional(signal.start) : std::nullopt;
    }
    if (signal.start >= 8 * length) return std::nullopt;
    const std::uint32_t highest = (7 - signal.start / 8) * 8 + signal.start % 8;
    const std::uint32_t unused = 8 * (8 - length);
    if (highest + 1 < signal.bits + unused) return std::nullopt;
    return highest + 1 - signal.bits;
}

Signal field(const DbcSignal& dbc, std::uint32_t shift) {
    Signal signal;
    signal.shift = static_cast<std::uint8_t>(shift);
    signal.bits = static_cast<std::uint8_t>(dbc.bits);
    signal.big_endian = dbc.big_endian;
    signal.is_signed = dbc.is_signed;
    const auto values = std::int64_t{1} << dbc.bits;
    signal.raw_min = dbc.is_signed ? -values / 2 : 0;
    signal.raw_max = (dbc.is_signed ? values / 2 : values) - 1;
    return signal;
}

/// The field's bits as they lie in the payload's bytes, whatever the order: for finding overlaps.
std::uint64_t occupied(const Signal& signal) {
    const std::uint64_t word = signal.mask() << signal.shift;
    if (!signal.big_endian) return word;
    std::uint64_t out = 0;
    for (unsigned i = 0; i < 8; ++i) out |= ((word >> (8U * i)) & 0xFFU) << (56U - 8U * i);
    return out;
}

}  // namespace

MessageBinder::MessageBinder(const Dbc& dbc, settings::Table table) : dbc_(dbc), table_(std::move(table)) {
    const std::string name = table_.text("message");
    for (const DbcMessage& candidate : dbc_.messages) {
        if (candidate.name != name) continue;
        if (message_ != nullptr) {
            table_.fail("message", "'" + name + "' is defined twice in " + dbc_.file + ", lines " + std::to_string(message_->line) + " and " +
                                       std::to_string(candidate.line));
        }
        message_ = &candidate;
    }
    if (message_ == nullptr) {
        table_.fail("message", "no message '" + name + "' in " + dbc_.file + suggestion(name, dbc_.messages));
    }
    const std::string where = dbc_.file + ":" + std::to_string(message_->line) + ": ";
    if (message_->extended || message_->id > 0x7FF) {
        table_.fail("message", where + "'" + name + "' has a 29-bit identifier; only 11-bit ones (0 to 2047) are used");
    }
    if (message_->length > 8) {
        table_.fail("message", where + "'" + name + "' has " + std::to_string(message_->length) + " bytes; a classic CAN frame has at most 8");
    }
}

std::string MessageBinder::at(const DbcSignal& signal) const {
    return "signal '" + signal.name + "' (" + dbc_.file + ":" + std::to_string(signal.line) + ")";
}

Message MessageBinder::message(bool cyclic) {
    Message message;
    message.bound = true;
    message.id = static_cast<std::uint16_t>(message_->id);
    message.length = static_cast<std::uint8_t>(message_->length);
    if (!cyclic) return message;
    const double period_ms = table_.number("period_ms", {.min = 0.1, .max = 1000.0});
    if (message_->cycle_time_ms && std::abs(*message_->cycle_time_ms - period_ms) > 1e-9) {
        std::string cycle_time = std::to_string(*message_->cycle_time_ms);
        cycle_time.erase(cycle_time.find_last_not_of('0') + 1);
        if (cycle_time.back() == '.') cycle_time.pop_back();
        table_.fail("period_ms", "contradicts GenMsgCycleTime of '" + message_->name + "' in " + dbc_.file + ", which is " + cycle_time + " ms");
    }
    message.period = control::Time{static_cast<std::int64_t>(std::round(period_ms * 1e6))};
    return message;
}

E2e MessageBinder::protection(bool crc_required, bool ordered) {
    static constexpr std::array<settings::Choice<Protection>, 3> kChoices{
        {{"none", Protection::none}, {"counter", Protection::counter}, {"counter_crc", Protection::counter_crc}}};
    E2e e2e;
    e2e.ordered = ordered;
    e2e.protection = table_.choice<Protection>("protection", kChoices);
    if (crc_required && e2e.protection != Protection::counter_crc) {
        table_.fail("protection", "must be \"counter_crc\": this message can move the valve");
    }
    if (e2e.protection == Protection::none) return e2e;

    const bool with_crc = e2e.protection == Protection::counter_crc;
    e2e.counter = with_crc ? whole("counter", {.min = 4, .max = 8}) : whole("counter", {.min = 2, .max = 8});
    e2e.counter_modulo = with_crc ? kProfileCounterModulo : static_cast<std::uint16_t>(std::uint32_t{1} << e2e.counter.bits);
    if (ordered) {
        e2e.max_delta = table_.integer<std::uint8_t>("max_delta", {.min = 1, .max = e2e.counter_modulo / 2});
    }
    if (with_crc) {
        const Signal crc = whole("crc", {.min = 8, .max = 8});
        if (crc.shift % 8 != 0) table_.fail("crc", "must fill one byte; this one lies across two");
        e2e.crc_byte = static_cast<std::uint8_t>(crc.big_endian ? 7 - crc.shift / 8 : crc.shift / 8);
        e2e.data_id = table_.integer<std::uint16_t>("data_id", {.min = 0, .max = 0xFFFF});
    }
    return e2e;
}

const DbcSignal& MessageBinder::take(const settings::Table& table, std::string_view key, const std::string& name) {
    const DbcSignal* found = nullptr;
    for (const DbcSignal& candidate : message_->signals) {
        if (candidate.name != name) continue;
        if (found != nullptr) table.fail(key, at(candidate) + " is defined twice in '" + message_->name + "'");
        found = &candidate;
    }
    if (found == nullptr) {
        table.fail(key, "no signal '" + name + "' in message '" + message_->name + "' of " + dbc_.file + suggestion(name, message_->signals));
    }
    if (!found->multiplexing.empty()) {
        table.fail(key, at(*found) + " is multiplexed (" + found->multiplexing + "); only plain signals can be used");
    }
    if (found->floating) table.fail(key, at(*found) + " is a floating-point signal; only integers can be used");
    if (found->factor == 0.0) table.fail(key, at(*found) + " has the factor 0");
    if (found->bits > kWidestClock) {
        table.fail(key, at(*found) + " has " + bits(found->bits) + "; at most " + bits(kWidestClock) + " can be used");
    }
    const std::optional<std::uint32_t> shift = shift_of(*found, message_->length);
    if (!shift) {
        table.fail(key, at(*found) + " sticks out of the " + std::to_string(message_->length) + " bytes of '" + message_->name + "'");
    }
    const std::uint64_t own = occupied(field(*found, *shift));
    for (const Taken& other : taken_) {
        if ((other.bits & own) != 0) table.fail(key, at(*found) + " overlaps that of " + other.key);
    }
    std::string path = table.path();
    if (key != kSignalKey) path.append(1, '.').append(key);
    taken_.push_back({own, std::move(path)});
    return *found;
}

Signal MessageBinder::whole(std::string_view key, const Widths& widths) {
    return whole(table_, key, widths);
}

Signal MessageBinder::whole(const settings::Table& table, std::string_view key, const Widths& widths) {
    const DbcSignal& signal = take(table, key, table.text(key));
    if (signal.bits < widths.min || signal.bits > widths.max) {
        std::string wanted = bits(widths.max);
        if (widths.min != widths.max) wanted.insert(0, std::to_string(widths.min) + " to ");
        table.fail(key, at(signal) + " has " + bits(signal.bits) + "; expected " + wanted);
    }
    if (signal.is_signed) table.fail(key, at(signal) + " is signed; expected an unsigned one");
    if (signal.factor != 1.0 || signal.offset != 0.0) {
        table.fail(key, at(signal) + " has a factor or offset; a count, code or flag has factor 1 and offset 0");
    }
    return field(signal, *shift_of(signal, message_->length));
}

Signal MessageBinder::code(std::string_view key, const Widths& widths, std::span<const std::string_view> names) {
    const Signal signal = whole(key, widths);
    const std::string name = table_.text(key);
    const auto dbc = std::ranges::find(message_->signals, name, &DbcSignal::name);
    for (const auto& [value, text] : dbc->values) {
        const auto known = std::ranges::find(names, text);
        if (known != names.end() && known - names.begin() != value) {
            table_.fail(key, at(*dbc) + " has '" + text + "' as value " + std::to_string(value) + "; it is " + std::to_string(known - names.begin()) +
                                 " here");
        }
    }
    return signal;
}

MessageBinder::Source MessageBinder::take_physical(std::string_view key) {
    const settings::Table inner = table_.table(key);
    const DbcSignal& signal = take(inner, kSignalKey, inner.text(kSignalKey));
    const std::string spelling = inner.text("unit");
    const std::optional<Unit> unit = find_unit(spelling);
    if (!unit) inner.fail("unit", "unknown unit '" + settings::printable(spelling) + "'");
    if (!signal.unit.empty() && find_unit(signal.unit) != unit) {
        inner.fail("unit", at(signal) + " is in '" + settings::printable(signal.unit) + "' there, '" + spelling + "' here");
    }
    return {.table = inner, .key = std::string(key), .signal = &signal, .unit = *unit};
}

Signal MessageBinder::scaled(const Source& source, double size) const {
    const DbcSignal& dbc = *source.signal;
    if (dbc.bits > kWidestPhysical) {
        source.table.fail(kSignalKey, at(dbc) + " has " + bits(dbc.bits) + "; at most " + bits(kWidestPhysical) + " can be used");
    }
    Signal signal = field(dbc, *shift_of(dbc, message_->length));
    if (dbc.min < dbc.max) {
        // The ends as raw numbers; a hair of tolerance, since 65.535 / 0.001 is not quite 65535.
        const double a = (dbc.min - dbc.offset) / dbc.factor;
        const double b = (dbc.max - dbc.offset) / dbc.factor;
        const double low = std::ceil(std::min(a, b) - 1e-6);
        const double high = std::floor(std::max(a, b) + 1e-6);
        if (low > static_cast<double>(signal.raw_max) || high < static_cast<double>(signal.raw_min) || low > high) {
            source.table.fail(kSignalKey, at(dbc) + " cannot hold any value of its own range");
        }
        if (low > static_cast<double>(signal.raw_min)) signal.raw_min = static_cast<std::int64_t>(low);
        if (high < static_cast<double>(signal.raw_max)) signal.raw_max = static_cast<std::int64_t>(high);
    }
    signal.scale = dbc.factor * size;
    signal.per_scale = 1.0 / signal.scale;
    signal.offset = dbc.offset * size;
    return signal;
}

Signal MessageBinder::scaled(const Source& source, double size, const RequiredRange::Ends& required) const {
    const Signal signal = scaled(source, size);
    const auto [min, max] = std::minmax({signal.value(signal.raw_min), signal.value(signal.raw_max)});
    const auto in_unit = [&](double value) {
        std::array<char, 32> number{};
        static_cast<void>(std::snprintf(number.data(), number.size(), "%g ", value / size));
        return number.data() + source.table.text("unit");
    };
    const auto check = [&](bool reaches, const char* verb, double end, double wanted) {
        if (!reaches)
            source.table.fail(kSignalKey, at(*source.signal) + verb + in_unit(end) + ", too narrow for this rig: it must reach " + in_unit(wanted));
    };
    const double half = 0.5 * std::abs(signal.scale);
    check(required.max <= 0.0 || max + half >= required.max, " ends at ", max, required.max);
    check(required.min >= 0.0 || min - half <= required.min, " begins at ", min, required.min);
    return signal;
}

Signal MessageBinder::physical(std::string_view key, Quantity quantity, const RequiredRange::Ends& required) {
    const Source source = take_physical(key);
    if (source.unit.quantity != quantity) source.table.fail("unit", "expected one of " + units_of(quantity));
    return scaled(source, source.unit.factor, required);
}

Signal MessageBinder::rotation(std::string_view key, double required) {
    const Source source = take_physical(key);
    const RequiredRange::Ends ends{.max = required};
    if (source.unit.quantity == Quantity::angular_speed) return scaled(source, source.unit.factor, ends);
    if (source.unit.quantity != Quantity::speed) {
        source.table.fail(
            "unit", "expected one of " + units_of(Quantity::angular_speed) + ", or of " + units_of(Quantity::speed) + " with radius_m of the rim");
    }
    const double radius_m = source.table.number("radius_m", {.min = 0.01, .max = 10.0});
    return scaled(source, source.unit.factor / radius_m, ends);
}

Signal MessageBinder::clock(std::string_view key) {
    const Source source = take_physical(key);
    const DbcSignal& dbc = *source.signal;
    if (source.unit.quantity != Quantity::time) source.table.fail("unit", "expected one of " + units_of(Quantity::time));
    if (dbc.is_signed || dbc.factor < 0.0 || dbc.offset != 0.0) {
        source.table.fail(kSignalKey, at(dbc) + " must be unsigned, with a positive factor and no offset");
    }
    Signal signal = field(dbc, *shift_of(dbc, message_->length));
    signal.scale = dbc.factor * source.unit.factor;
    signal.per_scale = 1.0 / signal.scale;
    if (signal.scale * static_cast<double>(signal.raw_max) < kMinRollOver_ns) {
        source.table.fail(kSignalKey, at(dbc) + " rolls over within 200 ms: too narrow to tell the time of an edge");
    }
    return signal;
}

}  // namespace antiskid::can
