#include "firmware/can/dbc.hpp"

#include <map>
#include <utility>

#include "firmware/can/dbc_cursor.hpp"
#include "firmware/host/settings/input_file.hpp"

namespace antiskid::can {

namespace {

constexpr std::uint32_t kExtendedFlag = 0x80000000U;

class Parser {
  public:
    Parser(std::string_view text, std::string file) : cursor_(text, file) { dbc_.file = std::move(file); }

    Dbc run() {
        while (cursor_.peek() != '\0') statement();
        return std::move(dbc_);
    }

  private:
    void statement() {
        if (std::string_view(":;,\"()[]|@").find(cursor_.peek()) != std::string_view::npos) return cursor_.skip_line();
        const std::string_view keyword = cursor_.word("a keyword");
        if (cursor_.at_line_end()) return;  // an entry of the NS_ list
        if (keyword == "BO_") return message();
        if (keyword == "SG_") return signal();
        if (keyword == "VAL_") return values();
        if (keyword == "CM_") return comment();
        if (keyword == "BA_") return attribute();
        if (keyword == "SIG_VALTYPE_") return value_type();
        cursor_.skip_line();
    }

    void message() {
        DbcMessage message;
        message.line = cursor_.line();
        const auto id = static_cast<std::uint32_t>(cursor_.natural("the message's identifier", 0xFFFFFFFFU));
        message.extended = (id & kExtendedFlag) != 0;
        message.id = id & ~kExtendedFlag;
        message.name = cursor_.word("the message's name");
        cursor_.expect(':', "after the message's name");
        message.length = static_cast<std::uint32_t>(cursor_.natural("the message's length in bytes", 0xFFFF));
        if (!cursor_.at_line_end()) message.sender = cursor_.word("the message's sender");
        cursor_.skip_line();
        messages_.emplace(id, dbc_.messages.size());
        dbc_.messages.push_back(std::move(message));
    }

    void signal() {
        if (dbc_.messages.empty()) cursor_.fail("SG_ before the first BO_: a signal belongs to a message");
        DbcSignal signal;
        signal.line = cursor_.line();
        signal.name = cursor_.word("the signal's name");
        if (!cursor_.at_line_end() && cursor_.peek() != ':') signal.multiplexing = cursor_.word("':' or a multiplexer mark (M, m0)");
        cursor_.expect(':', "after the signal's name");
        signal.start = static_cast<std::uint32_t>(cursor_.natural("the start bit", 0xFFFF));
        cursor_.expect('|', "after the start bit");
        signal.bits = static_cast<std::uint32_t>(cursor_.natural("the number of bits", 0xFFFF));
        cursor_.expect('@', "after the number of bits");
        signal.big_endian = cursor_.natural("the byte order: 1 Intel, 0 Motorola", 1) == 0;
        signal.is_signed = cursor_.sign("the sign") == '-';
        cursor_.expect('(', "before the factor");
        signal.factor = cursor_.number("the factor");
        cursor_.expect(',', "after the factor");
        signal.offset = cursor_.number("the offset");
        cursor_.expect(')', "after the offset");
        cursor_.expect('[', "before the minimum");
        signal.min = cursor_.number("the minimum");
        cursor_.expect('|', "after the minimum");
        signal.max = cursor_.number("the maximum");
        cursor_.expect(']', "after the maximum");
        signal.unit = cursor_.quoted("the unit");
        if (signal.bits == 0) cursor_.fail("signal '" + signal.name + "' has no bits");
        cursor_.skip_line();
        DbcMessage& message = dbc_.messages.back();
        signals_.emplace(std::pair(dbc_.messages.size() - 1, signal.name), message.signals.size());
        message.signals.push_back(std::move(signal));
    }

    void values() {
        if (cursor_.peek() < '0' || cursor_.peek() > '9') return cursor_.skip_statement();  // of an environment variable
        const std::uint32_t id = identifier();
        const std::string name(cursor_.word("the signal's name"));
        std::map<std::int64_t, std::string> values;
        while (cursor_.peek() != ';') {
            const double code = cursor_.number("a value or ';'");
            std::string text = cursor_.quoted("the value's text");
            if (code >= -9e15 && code <= 9e15) values[static_cast<std::int64_t>(code)] = std::move(text);
        }
        cursor_.skip_statement();
        if (DbcSignal* signal = find(id, name)) signal->values = std::move(values);
    }

    void comment() {
        if (cursor_.peek() == '"') return cursor_.skip_statement();  // of the whole file
        const std::string_view kind = cursor_.word("BU_, BO_, SG_ or a text");
        if (kind == "BO_") {
            const std::uint32_t id = identifier();
            std::string text = cursor_.quoted("the comment");
            if (DbcMessage* message = find(id)) message->comment = std::move(text);
        } else if (kind == "SG_") {
            const std::uint32_t id = identifier();
            const std::string name(cursor_.word("the signal's name"));
            std::string text = cursor_.quoted("the comment");
            if (DbcSignal* signal = find(id, name)) signal->comment = std::move(text);
        }
        cursor_.skip_statement();
    }

    void attribute() {
        const std::string name = cursor_.quoted("the attribute's name");
        if (name == "GenMsgCycleTime" && cursor_.peek() == 'B') {
            if (cursor_.word("BO_") == "BO_") {
                const std::uint32_t id = identifier();
                const double cycle_time_ms = cursor_.number("the cycle time in ms");
                if (DbcMessage* message = find(id); message != nullptr && cycle_time_ms > 0.0) {
                    message->cycle_time_ms = cycle_time_ms;
                }
            }
        }
        cursor_.skip_statement();
    }

    void value_type() {
        const std::uint32_t id = identifier();
        const std::string name(cursor_.word("the signal's name"));
        if (cursor_.peek() == ':') cursor_.expect(':', "after the signal's name");
        const std::uint64_t type = cursor_.natural("the value type: 0 integer, 1 float, 2 double", 3);
        if (DbcSignal* signal = find(id, name)) signal->floating = type != 0;
        cursor_.skip_statement();
    }

    std::uint32_t identifier() { return static_cast<std::uint32_t>(cursor_.natural("a message's identifier", 0xFFFFFFFFU)); }

    DbcMessage* find(std::uint32_t id) {
        const auto found = messages_.find(id);
        return found == messages_.end() ? nullptr : &dbc_.messages[found->second];
    }

    DbcSignal* find(std::uint32_t id, const std::string& name) {
        const auto message = messages_.find(id);
        if (message == messages_.end()) return nullptr;
        const auto found = signals_.find({message->second, name});
        return found == signals_.end() ? nullptr : &dbc_.messages[message->second].signals[found->second];
    }

    DbcCursor cursor_;
    Dbc dbc_;
    /// Places of the first of an identifier, flag included, and of the first of a name in a message: a table of a large DBC names each.
    std::map<std::uint32_t, std::size_t> messages_;
    std::map<std::pair<std::size_t, std::string>, std::size_t> signals_;
};

}  // namespace

Dbc load_dbc(const std::filesystem::path& path) {
    return parse_dbc(settings::read_file(path), path.string());
}

Dbc parse_dbc(std::string_view text, std::string file) {
    return Parser(text, std::move(file)).run();
}

}  // namespace antiskid::can
