#include "rig_bridge/panel/broadcast.hpp"

#include <utility>

namespace rig::panel {

void Broadcast::publish(std::string_view event, const std::string& data) {
    std::string text = "event: ";
    text.append(event).append("\ndata: ").append(data).append("\n\n");
    {
        const std::lock_guard lock(mutex_);
        kept_.push_back(std::move(text));
        if (kept_.size() > kKept) {
            kept_.pop_front();
            ++first_;
        }
    }
    changed_.notify_all();
}

void Broadcast::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    changed_.notify_all();
}

std::optional<std::string> Broadcast::take(Place& place, std::chrono::milliseconds wait) {
    std::unique_lock lock(mutex_);
    std::string text;
    if (!place.began) place = {.began = true, .next = first_};
    changed_.wait_for(lock, wait, [&] { return closed_ || first_ + kept_.size() > place.next; });
    if (closed_ || place.next < first_) return std::nullopt;
    for (; place.next < first_ + kept_.size(); ++place.next) text += kept_[place.next - first_];
    return text.empty() ? ":\n\n" : text;
}

}  // namespace rig::panel
