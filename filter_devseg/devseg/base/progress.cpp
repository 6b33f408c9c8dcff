#include "devseg/base/progress.h"

#include <algorithm>

#include "devseg/base/errors.h"

namespace devseg {

namespace {
// Hosts redraw a progress bar at every call: more often than this only costs time, and less often
// would make cancelling feel slow.
constexpr std::chrono::milliseconds minimum_interval{20};
} // namespace

void Progress::begin_phase(const char* name, double share) {
    phase_start_ = std::min(1.0, phase_start_ + phase_share_);
    phase_share_ = std::clamp(share, 0.0, 1.0 - phase_start_);
    phase_ = name;
    owner_ = std::this_thread::get_id();
    last_call_ = {};
    update(0.0);
}

// The fraction of the last report, at most once in the interval; false where the user said stop.
bool Progress::ask_host() const {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_call_ < minimum_interval)
        return true;
    last_call_ = now;
    if (callback_(last_fraction_, phase_))
        return true;
    cancelled_.store(true, std::memory_order_relaxed);
    return false;
}

void Progress::update(double phase_fraction) {
    const double fraction = phase_start_ + phase_share_ * std::clamp(phase_fraction, 0.0, 1.0);
    last_fraction_ = std::max(last_fraction_, fraction);
    if (cancelled() || (callback_ && !ask_host()))
        throw Cancelled();
}

void Progress::pass_on(double fraction, const char* phase) {
    owner_ = std::this_thread::get_id();
    phase_ = phase;
    last_fraction_ = std::max(last_fraction_, fraction);
    last_call_ = {};
    check();
}

void Progress::check() const {
    if (cancelled() || (callback_ && std::this_thread::get_id() == owner_ && !ask_host()))
        throw Cancelled();
}

} // namespace devseg
