#include "devseg/base/worker.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "devseg/base/parallel.h"

namespace devseg {

namespace {

constexpr std::size_t most_abandoned = 2; // that still run, and keep their memory

struct Report {
    double fraction;
    const char* phase;
};

// What the two threads share.
struct Exchange {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<Report> reports; // not passed on yet
    bool done = false;
    std::exception_ptr failure;
    std::atomic<bool> stop{false};
};

struct Runner {
    std::thread thread;
    std::shared_ptr<Exchange> exchange;
};

// Threads of cancelled work, which nobody waits for.
class Abandoned {
public:
    ~Abandoned() {
        for (Runner& runner : runners_)
            runner.thread.join();
    }
    void take(std::list<Runner>& runner) noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        runners_.splice(runners_.end(), runner);
    }
    // Returns how many there are still.
    std::size_t forget_ended() {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (auto runner = runners_.begin(); runner != runners_.end();) {
            if (!has_ended(*runner)) {
                ++runner;
                continue;
            }
            runner->thread.join();
            runner = runners_.erase(runner);
        }
        return runners_.size();
    }

private:
    static bool has_ended(const Runner& runner) {
        const std::lock_guard<std::mutex> lock(runner.exchange->mutex);
        return runner.exchange->done;
    }

    std::mutex mutex_;
    std::list<Runner> runners_;
};

Abandoned& abandoned() {
    static Abandoned threads;
    return threads;
}

void run(Exchange& exchange, std::function<void(Progress&)>& work) {
    Progress progress([&exchange](double fraction, const char* phase) {
        const std::lock_guard<std::mutex> lock(exchange.mutex);
        exchange.reports.push_back({fraction, phase});
        exchange.changed.notify_one();
        return !exchange.stop;
    });
    std::exception_ptr failure;
    try {
        work(progress);
    } catch (...) {
        failure = std::current_exception();
    }
    work = nullptr; // what it owns goes before anybody hears of the end
    const std::lock_guard<std::mutex> lock(exchange.mutex);
    exchange.failure = failure;
    exchange.done = true;
    exchange.changed.notify_one();
}

// Until the end of the work, or an exception of the host, Cancelled among them.
void pass_on_reports(Exchange& exchange, Progress& progress) {
    std::vector<Report> reports;
    for (bool done = false; !done;) {
        {
            std::unique_lock<std::mutex> lock(exchange.mutex);
            exchange.changed.wait_for(lock, report_interval,
                                      [&] { return exchange.done || !exchange.reports.empty(); });
            reports.swap(exchange.reports);
            exchange.reports.clear();
            done = exchange.done;
        }
        for (const Report& report : reports)
            progress.pass_on(report.fraction, report.phase);
        progress.check();
    }
}

} // namespace

void run_on_worker(std::function<void(Progress&)> work, Progress& progress) {
    while (abandoned().forget_ended() >= most_abandoned) {
        progress.pass_on(0.0, "waiting for cancelled work to end");
        std::this_thread::sleep_for(report_interval);
    }
    std::list<Runner> runner(1); // made now: abandoning it must not fail
    const auto exchange = std::make_shared<Exchange>();
    runner.front().exchange = exchange;
    try {
        runner.front().thread =
            std::thread([exchange, own = work]() mutable { run(*exchange, own); });
    } catch (const std::exception&) { // short of memory or threads: cancelled later, if at all
        work(progress);
        return;
    }
    work = nullptr;
    try {
        pass_on_reports(*exchange, progress);
    } catch (...) {
        exchange->stop = true;
        abandoned().take(runner);
        throw;
    }
    runner.front().thread.join();
    if (exchange->failure)
        std::rethrow_exception(exchange->failure);
}

} // namespace devseg
