#include "firmware/host/frame_intake.hpp"

#include <algorithm>

namespace antiskid::host {

bool FrameIntake::has_next(const bool first, const control::Time longest) {
    if (next_ < end_) return true;
    if (!first && end_ < batch_.size()) return false;  // a batch that is not full was all there is
    next_ = 0;
    end_ = first && longest > control::Time{0} ? bus_.receive_within(longest, batch_) : bus_.receive(batch_);
    return end_ > 0;
}

FrameIntake::Taken FrameIntake::drain(const control::Time now) {
    Taken taken;
    while (taken.frames < kMax && has_next(taken.frames == 0, {})) {
        can::Frame& frame = batch_[next_++];
        frame.received = std::min(frame.received, now);
        port_.accept(frame);
        ++taken.frames;
    }
    taken.full = taken.frames == kMax;
    return taken;
}

FrameIntake::Taken FrameIntake::take_until_sync(const control::Time now, const control::Time longest) {
    Taken taken;
    const std::uint32_t syncs = port_.sync_count();
    while (taken.frames < kMax && !taken.sync && has_next(taken.frames == 0, longest)) {
        can::Frame& frame = batch_[next_++];
        taken.sync_received = frame.received;
        frame.received = now;
        port_.accept(frame);
        ++taken.frames;
        taken.sync = port_.sync_count() != syncs;
    }
    taken.full = taken.frames == kMax;
    return taken;
}

}  // namespace antiskid::host
