/// The controller on a Cortex-M7, with a recorded bus in place of a peripheral: reads a stream (stream.hpp), answers as the program does in
/// lockstep, writes the frames, and counts instructions, stack and memory.
///
///     pil IN OUT          (the semihosting command line)

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/cortex_m/semihosting.hpp"
#include "firmware/cortex_m/stream.hpp"
#include "tables.hpp"

extern "C" std::uint32_t __stack_bottom, __stack_top;  // NOLINT(bugprone-reserved-identifier)

namespace {

using antiskid::can::ControllerPort;
using antiskid::can::Frame;
using antiskid::control::Command;
using antiskid::control::Controller;
using antiskid::control::Time;
using antiskid::cortex_m::Head;
using antiskid::cortex_m::Record;

/// SysTick, counting down at the processor's clock. Armv7-M Architecture Reference Manual, B3.3.
class Ticks {
  public:
    static constexpr std::uint32_t kMask = 0xFF'FFFF;

    Ticks() {
        reload() = kMask;
        current() = 0;
        control() = 0b101;  // enabled, no interrupt, processor clock
    }
    [[nodiscard]] static std::uint32_t now() { return current(); }
    [[nodiscard]] static std::uint32_t since(std::uint32_t before) { return (before - now()) & kMask; }

  private:
    using Register = volatile std::uint32_t&;
    static Register control() { return *reinterpret_cast<volatile std::uint32_t*>(0xE000'E010U); }
    static Register reload() { return *reinterpret_cast<volatile std::uint32_t*>(0xE000'E014U); }
    static Register current() { return *reinterpret_cast<volatile std::uint32_t*>(0xE000'E018U); }
};

struct Cost {
    std::uint32_t worst = 0;
    std::uint64_t sum = 0;
    void add(std::uint32_t ticks) {
        worst = std::max(worst, ticks);
        sum += ticks;
    }
};

class Input {
  public:
    explicit Input(std::intptr_t handle) : handle_(handle) {}

    [[nodiscard]] bool next(Record& record) {
        if (at_ == filled_) {
            filled_ = semihosting::read(handle_, records_.data(), sizeof records_) / sizeof(Record);
            at_ = 0;
            if (filled_ == 0) return false;
        }
        record = records_[at_++];
        return true;
    }

  private:
    std::intptr_t handle_;
    std::array<Record, 1024> records_{};
    std::size_t at_ = 0, filled_ = 0;
};

class Output {
  public:
    explicit Output(std::intptr_t handle) : handle_(handle) {}

    void add(const Frame& frame) {
        records_[count_++] = {
            .id = static_cast<std::uint16_t>(frame.id), .length = frame.length, .kind = Record::Kind::frame, .unused = 0, .data = frame.data};
        if (count_ == records_.size()) flush();
    }
    void flush() {
        failed_ = failed_ || semihosting::write(handle_, records_.data(), count_ * sizeof(Record)) != 0;
        count_ = 0;
    }
    [[nodiscard]] bool failed() const { return failed_; }

  private:
    std::intptr_t handle_;
    std::array<Record, 1024> records_{};
    std::size_t count_ = 0;
    bool failed_ = false;
};

/// Free stack is filled with this; what is still there at the end was never used.
constexpr std::uint32_t kUntouched = 0xDEAD'BEEF;

void paint_stack() {
    std::uint32_t* end = nullptr;
    asm volatile("mov %0, sp" : "=r"(end));
    for (std::uint32_t* word = &__stack_bottom; word < end; ++word) *word = kUntouched;
}

[[nodiscard]] std::uint32_t stack_used() {
    const std::uint32_t* word = &__stack_bottom;
    while (word < &__stack_top && *word == kUntouched) ++word;
    return static_cast<std::uint32_t>((&__stack_top - word) * static_cast<std::ptrdiff_t>(sizeof(std::uint32_t)));
}

/// `"name": value` and a comma, to the console: all that this program needs of a formatter.
void report(const char* name, std::uint64_t value, bool last = false) {
    std::array<char, 24> digits{};
    std::size_t at = digits.size() - 1;
    do {
        digits[--at] = static_cast<char>('0' + value % 10);
        value /= 10;
    } while (value != 0);
    semihosting::write_text("\"");
    semihosting::write_text(name);
    semihosting::write_text("\": ");
    semihosting::write_text(&digits[at]);
    semihosting::write_text(last ? "}\n" : ", ");
}

int fail(const char* what) {
    semihosting::write_text(what);
    return 1;
}

/// The second and third word of the command line.
struct Names {
    std::array<char, 512> line{};
    const char* in = nullptr;
    const char* out = nullptr;
    std::size_t in_length = 0, out_length = 0;

    [[nodiscard]] bool read() {
        std::size_t left = semihosting::command_line(line.data(), line.size());
        char* const end = line.data() + left;
        char* const first = std::find(line.data(), end, ' ');
        if (first == end) return false;
        char* const second = std::find(first + 1, end, ' ');
        if (second == end) return false;
        *second = '\0';
        in = first + 1;
        in_length = static_cast<std::size_t>(second - in);
        out = second + 1;
        out_length = static_cast<std::size_t>(std::find(second + 1, end, '\0') - out);
        return true;
    }
};

// Static, as on a board: the stack is left for calls.
Names names;
Controller controller(kControl);

}  // namespace

int recorded_bus();

int recorded_bus() {
    paint_stack();
    if (!names.read()) return fail("usage: pil IN OUT\n");
    const std::intptr_t in = semihosting::open(names.in, names.in_length, semihosting::Mode::read_binary);
    if (in < 0) return fail("the input cannot be opened\n");
    Head head;
    if (semihosting::read(in, &head, sizeof head) != sizeof head || head.magic != Head::kMagic)
        return fail("the input is no stream of cortex-m-prepare\n");
    const std::intptr_t out = semihosting::open(names.out, names.out_length, semihosting::Mode::write_binary);
    if (out < 0) return fail("the output cannot be opened\n");

    const Time period{head.period_ns};
    static ControllerPort port(kLayout, period);
    static Input input(in);
    static Output output(out);
    const Ticks ticks;
    const std::uint32_t began = Ticks::now();
    const std::uint32_t overhead = Ticks::since(began);
    Cost step_cost;
    Cost period_cost;
    std::uint32_t accepting = 0;
    std::int64_t steps = 0;
    Record record;
    while (input.next(record)) {
        const Time now = period * steps;
        if (record.kind == Record::Kind::frame) {
            const Frame frame{.id = record.id, .length = record.length, .data = record.data, .received = now};
            const std::uint32_t before = Ticks::now();
            port.accept(frame);
            accepting += Ticks::since(before) - overhead;
            continue;
        }
        const std::uint32_t before = Ticks::now();
        const Command command = controller.step(port.sensors(), now);
        const std::uint32_t step = Ticks::since(before) - overhead;
        port.clear_one_shots();
        std::array<Frame, ControllerPort::kMaxFrames> answer{};
        const std::size_t answers = port.due_frames(command, answer);
        // As in lockstep: the valve command, first of what is due, goes last.
        std::rotate(answer.begin(), answer.begin() + 1, answer.begin() + answers);
        step_cost.add(step);
        period_cost.add(accepting + Ticks::since(before) - overhead);
        for (std::size_t i = 0; i < answers; ++i) output.add(answer[i]);
        accepting = 0;
        ++steps;
    }
    output.flush();
    semihosting::close(out);
    if (output.failed()) return fail("the output cannot be written\n");
    semihosting::write_text("{");
    report("steps", static_cast<std::uint64_t>(steps));
    report("step_worst_ticks", step_cost.worst);
    report("step_sum_ticks", step_cost.sum);
    report("period_worst_ticks", period_cost.worst);
    report("period_sum_ticks", period_cost.sum);
    report("stack_bytes", stack_used());
    report("controller_bytes", sizeof controller);
    report("port_bytes", sizeof port);
    report("tables_bytes", sizeof kControl + sizeof kLayout, true);
    return 0;
}
