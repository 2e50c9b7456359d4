#include "rig_bridge/record/sample_stream.hpp"

#include <cmath>

#include "firmware/can/roles.hpp"

namespace rig::record {

using antiskid::can::Role;
using antiskid::control::kNever;

std::optional<Role> SampleStream::accept(const antiskid::can::Frame& frame) {
    ended_ = false;
    const auto role = observer_.accept(frame);
    if (role == Role::sync) {
        if (!count_sync()) return role;
    } else if (role == Role::pressure && !sync_ && !sync_expected_) {
        count_stamp(frame.received);
    } else {
        return role;
    }
    ended_ = view().wheel.received != kNever && view().flywheel.received != kNever && view().pressure.received != kNever;
    return role;
}

/// The number has no CRC: a jump counts only when the next number continues from it.
bool SampleStream::count_sync() {
    const std::uint32_t number = view().sync_number;
    const antiskid::can::Signal& counter = layout_.sync_counter;
    std::uint64_t passed = 1;
    if (sync_ && counter.bound()) {
        const std::uint64_t mask = counter.mask();
        passed = (number - last_sync_) & mask;
        if (passed == 0) return false;  // a repeated sample
        constexpr std::uint64_t kLeap = 8;
        const bool goes_on = leapt_to_ && ((number - *leapt_to_) & mask) == 1;
        leapt_to_.reset();
        if (passed > kLeap && !goes_on) {
            leapt_to_ = number;
            return false;
        }
        if (passed > mask / 2) {
            passed = 1;  // the rig has restarted its count
            ++restarts_;
        }
    }
    sync_ = true;
    last_sync_ = number;
    syncs_ += passed;
    time_s_ = static_cast<double>(syncs_) * period_s_;
    time_ = antiskid::can::Time{std::llround(period_s_ * 1e9)} * static_cast<std::int64_t>(syncs_);
    return true;
}

void SampleStream::count_stamp(antiskid::can::Time stamp) {
    const std::int64_t us = stamp.count() / 1000;
    if (!stamped_) first_us_ = newest_us_ = us;
    stamped_ = true;
    if (us < newest_us_) {
        // From here on the stamps continue from the previous ones.
        first_us_ -= newest_us_ - us;
        ++steps_back_;
    }
    newest_us_ = us;
    time_s_ = static_cast<double>(us - first_us_) * 1e-6;
    time_ = antiskid::can::Time{(us - first_us_) * 1000};
}

}  // namespace rig::record
