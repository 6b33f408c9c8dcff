// Progress and cancellation of long work: one monotone fraction over nested parts.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>

namespace devseg {

/// The whole of a run, or a part of it that ends with its scope:
///
///     auto joining = progress.part("joining", 0.3);
///     join_charts(mesh, options, joining); // reports 0 to 1 of these 0.3
///
/// The fraction of the whole never runs back, and parts never take more than there is.
class Progress {
public:
    /// Called with the fraction of the whole in [0, 1] and the name of the innermost part; returns
    /// false to cancel.
    using Callback = std::function<bool(double fraction, const char* name)>;

    explicit Progress(Callback callback = {});
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// The next part: takes `share` (0 to 1) of this work, or what other parts have left of it. It
    /// begins where the part before it ends, and ends with its scope. Throws Cancelled when the
    /// user has cancelled. Only the thread that runs the filter may call it.
    [[nodiscard]] Progress part(const char* name, double share);

    /// The same under the name that there is, for rounds and charts.
    [[nodiscard]] Progress part(double share);

    /// What parts have left of this work, from 1 to 0.
    double left() const noexcept { return 1.0 - used_; }

    /// Reports the fraction of what parts have left; throws Cancelled when the user has cancelled.
    /// Only the thread that runs the filter may call it: hosts touch their windows here.
    void update(double fraction);

    /// Reports what another progress object of the same run was told, as it was told; throws
    /// Cancelled when the user has cancelled.
    void pass_on(double fraction, const char* name);

    /// True once the user has cancelled. Any thread may ask.
    bool cancelled() const noexcept { return run_->cancelled.load(std::memory_order_relaxed); }

    /// Throws Cancelled once the user has cancelled. Any thread may call it; the thread that began
    /// the part asks the host at the same time, so that long work need not know its fraction.
    void check() const;

private:
    // What all parts of a run share.
    struct Run {
        Callback callback;
        std::thread::id owner; // none before the first part
        std::atomic<bool> cancelled{false};
        const char* name = "";
        double fraction = 0.0;
        std::chrono::steady_clock::time_point last_call{};

        bool ask_host();
    };

    Progress(Progress& whole, const char* name, double share);
    double position(double fraction) const;

    std::unique_ptr<Run> own_; // of the whole
    Run* run_;
    const char* name_before_ = "";
    double begin_ = 0.0; // of the whole
    double size_ = 1.0;  // of the whole
    double used_ = 0.0;  // by parts, of this work
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
