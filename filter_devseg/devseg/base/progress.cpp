#include "devseg/base/progress.h"

#include <algorithm>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"

namespace devseg {

Progress::Progress(Callback callback) : own_(std::make_unique<Run>()), run_(own_.get()) {
    run_->callback = std::move(callback);
}

Progress::Progress(Progress& whole, const char* name, double share)
    : run_(whole.run_), name_before_(run_->name), begin_(whole.position(0.0)),
      size_(whole.size_ * std::clamp(share, 0.0, whole.left())) {
    whole.used_ += std::clamp(share, 0.0, whole.left());
    if (name != run_->name)
        run_->last_call = {}; // a new name is shown at once
    run_->name = name;
    run_->owner = std::this_thread::get_id();
    update(0.0);
}

Progress::~Progress() {
    if (own_)
        return;
    run_->fraction = std::max(run_->fraction, position(1.0));
    run_->name = name_before_;
}

Progress Progress::part(const char* name, double share) {
    return {*this, name, share};
}

Progress Progress::part(double share) {
    return {*this, run_->name, share};
}

// In the whole, of a fraction of what parts have left.
double Progress::position(double fraction) const {
    return std::min(1.0, begin_ + size_ * (used_ + left() * std::clamp(fraction, 0.0, 1.0)));
}

// The fraction of the last report, at most once in the interval; false where the user cancelled.
bool Progress::Run::ask_host() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_call < report_interval)
        return true;
    last_call = now;
    if (callback(fraction, name))
        return true;
    cancelled.store(true, std::memory_order_relaxed);
    return false;
}

void Progress::update(double fraction) {
    run_->fraction = std::max(run_->fraction, position(fraction));
    if (cancelled() || (run_->callback && !run_->ask_host()))
        throw Cancelled();
}

void Progress::pass_on(double fraction, const char* name) {
    run_->owner = std::this_thread::get_id();
    run_->name = name;
    run_->last_call = {};
    run_->fraction = std::max(run_->fraction, begin_ + size_ * fraction);
    check();
}

void Progress::check() const {
    if (cancelled() ||
        (run_->callback && std::this_thread::get_id() == run_->owner && !run_->ask_host()))
        throw Cancelled();
}

} // namespace devseg
