// Progress and cancellation of long work: one monotone fraction over named phases.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace devseg {

class Progress {
public:
    /// Called with the overall fraction in [0, 1] and the phase; returns false to cancel.
    using Callback = std::function<bool(double fraction, const char* phase)>;

    Progress() = default;
    explicit Progress(Callback callback) : callback_(std::move(callback)) {}
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Starts a phase that takes the given share (0 to 1) of the whole run.
    void begin_phase(const char* name, double share);

    /// Reports the fraction of the current phase; throws Cancelled when the user said stop.
    /// Only the thread that runs the filter may call it: hosts touch their windows here.
    void update(double phase_fraction);

    /// Reports what another progress object of the same run was told, as it was told; throws
    /// Cancelled when the user said stop.
    void pass_on(double fraction, const char* phase);

    /// True once the user said stop. Any thread may ask.
    bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

    /// Throws Cancelled once the user said stop. Any thread may call it; the thread that began
    /// the phase asks the host at the same time, so that long work need not know its fraction.
    void check() const;

private:
    bool ask_host() const;

    Callback callback_;
    std::thread::id owner_; // none before the first phase
    mutable std::atomic<bool> cancelled_{false};
    const char* phase_ = "";
    double phase_start_ = 0.0;
    double phase_share_ = 0.0;
    double last_fraction_ = 0.0;
    mutable std::chrono::steady_clock::time_point last_call_{};
};

/// Checks for cancellation once in so many steps of a loop that is short of time.
class Heartbeat {
public:
    explicit Heartbeat(const Progress& progress) : progress_(progress) {}
    void operator()() {
        if ((++steps_ & 1023U) == 0)
            progress_.check();
    }

private:
    const Progress& progress_;
    unsigned steps_ = 0;
};

} // namespace devseg
