/// Resolves one role's table of the binding against the DBC: finds the message and its signals, checks them and makes Signals of them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/dbc.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/units.hpp"
#include "firmware/host/settings/settings.hpp"

namespace antiskid::can {

/// Widths that a whole-number signal may have.
struct Widths {
    std::uint32_t min = 1;
    std::uint32_t max = 32;
};

/// Every function throws settings::Error at the binding's key that is wrong. `dbc` must outlive the object.
class MessageBinder {
  public:
    /// Looks up the `message` of `table`, the role's table, in `dbc`.
    MessageBinder(const Dbc& dbc, settings::Table table);

    /// Identifier, length, and `period_ms` for a cyclic message.
    [[nodiscard]] Message message(bool cyclic);
    /// `protection` and the keys that belong to it.
    [[nodiscard]] E2e protection(bool crc_required, bool ordered);

    /// `key = "SignalName"`: a code, count or flag, without unit, factor and offset.
    [[nodiscard]] Signal whole(std::string_view key, const Widths& widths);
    [[nodiscard]] Signal whole(const settings::Table& table, std::string_view key, const Widths& widths);
    /// As whole(); a value table in the DBC must not give a code the name that `names` has for another one.
    [[nodiscard]] Signal code(std::string_view key, const Widths& widths, std::span<const std::string_view> names);
    /// `key = { signal = "SignalName", unit = "bar" }`.
    /// `required`: values that the field must be able to represent, in the controller's unit.
    [[nodiscard]] Signal physical(std::string_view key, Quantity quantity, const RequiredRange::Ends& required = {});
    /// An angular speed, given in a unit of angular speed, or in a unit of rim speed together with the rim's `radius_m`. `required`: rad/s
    /// that the field must be able to represent.
    [[nodiscard]] Signal rotation(std::string_view key, double required = 0.0);
    /// The time of an edge: unsigned, rolls over, no offset.
    [[nodiscard]] Signal clock(std::string_view key);

    [[nodiscard]] const settings::Table& table() const { return table_; }

  private:
    struct Source {
        settings::Table table;
        std::string key;
        const DbcSignal* signal;
        Unit unit;
    };
    const DbcSignal& take(const settings::Table& table, std::string_view key, const std::string& name);
    [[nodiscard]] Source take_physical(std::string_view key);
    [[nodiscard]] Signal scaled(const Source& source, double size) const;
    [[nodiscard]] Signal scaled(const Source& source, double size, const RequiredRange::Ends& required) const;
    [[nodiscard]] std::string at(const DbcSignal& signal) const;

    const Dbc& dbc_;
    settings::Table table_;
    const DbcMessage* message_ = nullptr;
    /// Payload bits used by a signal that is already bound, in Intel numbering, and that signal's key.
    struct Taken {
        std::uint64_t bits;
        std::string key;
    };
    std::vector<Taken> taken_;
};

}  // namespace antiskid::can
