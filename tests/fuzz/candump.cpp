// A line of a bus log is read or refused with its column; what was read is written, and read again as the same.
#include <array>
#include <variant>

#include "firmware/can/candump.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace antiskid::can;
    const fuzz::Input input(data, size);
    const auto parsed = parse_candump(input.text());
    if (const auto* failure = std::get_if<CandumpFailure>(&parsed)) {
        fuzz::require(failure->column >= 1 && failure->column <= size + 1 && *failure->what != '\0');
        return 0;
    }
    const auto& line = std::get<CandumpLine>(parsed);
    fuzz::require(line.frame.length <= 8 && line.time.count() >= 0 && !line.interface.empty());
    fuzz::require(line.extended || line.error || line.frame.id <= 0x7FF);
    std::array<char, kCandumpLineMax> text{};
    const std::size_t written = format_candump(line, text);
    if (written == 0) {
        fuzz::require(line.interface.size() > 15);
        return 0;
    }
    const auto again = parse_candump({text.data(), written});
    fuzz::require(std::holds_alternative<CandumpLine>(again));
    const auto& same = std::get<CandumpLine>(again);
    fuzz::require(same.frame.id == line.frame.id && same.frame.length == line.frame.length && same.frame.data == line.frame.data);
    fuzz::require(same.extended == line.extended && same.error == line.error && same.remote == line.remote);
    fuzz::require(same.time.count() == line.time.count() / 1000 * 1000 && same.interface == line.interface);
    return 0;
}
