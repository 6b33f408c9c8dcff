#include "devseg/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

namespace devseg {

namespace {

std::atomic<int> thread_limit{0};

int worker_count(int tasks) {
    const int limit = thread_limit.load();
    const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    return std::min(tasks, limit > 0 ? limit : cores);
}

struct Pool {
    std::mutex mutex;
    std::condition_variable changed;
    std::atomic<int> next{0};
    std::atomic<bool> stop{false};
    int done = 0;
    int running = 0;
    int failed_index = -1;
    std::exception_ptr failure;
};

void work(Pool& pool, int count, const std::function<void(int)>& task) {
    for (int index = pool.next++; index < count && !pool.stop; index = pool.next++) {
        std::exception_ptr failure;
        try {
            task(index);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard<std::mutex> lock(pool.mutex);
        ++pool.done;
        if (failure) {
            pool.stop = true;
            // Tasks start in order, so the lowest failing index has always been started:
            // keeping it makes the reported error independent of the thread count.
            if (pool.failed_index < 0 || index < pool.failed_index) {
                pool.failed_index = index;
                pool.failure = failure;
            }
        }
        pool.changed.notify_one();
    }
    const std::lock_guard<std::mutex> lock(pool.mutex);
    --pool.running;
    pool.changed.notify_one();
}

// A system that is short of memory may start fewer threads than asked for, which changes nothing
// but the time; without any, nothing has been done.
std::vector<std::thread> start_workers(Pool& pool, int count,
                                       const std::function<void(int)>& task) {
    std::vector<std::thread> workers;
    const int wanted = worker_count(count);
    workers.reserve(static_cast<std::size_t>(wanted));
    for (int i = 0; i < wanted; ++i) {
        const auto change_running = [&](int by) {
            const std::lock_guard<std::mutex> lock(pool.mutex);
            pool.running += by;
        };
        change_running(1); // before it ends
        try {
            workers.emplace_back([&pool, count, &task] { work(pool, count, task); });
        } catch (const std::exception&) { // no thread, or no memory for what describes it
            change_running(-1);
            break;
        }
    }
    if (workers.empty())
        throw std::bad_alloc();
    return workers;
}

} // namespace

void set_thread_limit(int threads) {
    thread_limit = std::max(0, threads);
}

void parallel_for(int count, const std::function<void(int)>& task, Progress& progress) {
    if (count <= 0)
        return;
    Pool pool;
    std::vector<std::thread> workers = start_workers(pool, count, task);

    std::exception_ptr interruption; // cancelled, or the host's callback failed
    {
        std::unique_lock<std::mutex> lock(pool.mutex);
        while (pool.running > 0) {
            pool.changed.wait_for(lock, report_interval);
            const double fraction = static_cast<double>(pool.done) / count;
            lock.unlock();
            try {
                if (!interruption)
                    progress.update(fraction);
            } catch (...) {
                interruption = std::current_exception();
                pool.stop = true;
            }
            lock.lock();
        }
    }
    for (std::thread& worker : workers)
        worker.join();
    if (interruption)
        std::rethrow_exception(interruption);
    if (pool.failure)
        std::rethrow_exception(pool.failure);
}

} // namespace devseg
