// Independent tasks on all cores, with results that do not depend on the number of threads.
#pragma once

#include <chrono>
#include <functional>

#include "devseg/base/progress.h"

namespace devseg {

/// How often hosts are told and asked. They redraw a progress bar at every call: more often only
/// costs time, and less often makes cancelling feel slow.
constexpr std::chrono::milliseconds report_interval{20};

/// Limits the worker threads of parallel_for; 0 = one for each core. For tests and batch hosts.
void set_thread_limit(int threads);

/// Runs task(0) ... task(count − 1), each exactly once, on worker threads, lowest index first.
/// The calling thread reports progress and polls for cancellation. The exception of the lowest
/// failing index is rethrown once all workers have stopped.
void parallel_for(int count, const std::function<void(int)>& task, Progress& progress);

} // namespace devseg
