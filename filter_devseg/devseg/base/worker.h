// Long work on a thread of its own, so that it can be cancelled whatever it is busy with: libraries
// factorize matrices and contract skeletons for seconds without a look at the progress object.
#pragma once

#include <functional>

#include "devseg/base/progress.h"

namespace devseg {

/// Calls work(p) and returns when it has ended; what it throws is rethrown. The calling thread
/// passes on to `progress` what is reported to p, and asks it at least every 20 ms. When the user
/// cancels, the work is abandoned: Cancelled is thrown at once, p is cancelled as well, and the
/// thread ends at its next check. `work` must therefore own all that it reads and writes. With two
/// abandoned threads the next work waits for one of them to end, as they keep their memory; all are
/// waited for when the library is unloaded or the process ends.
void run_on_worker(std::function<void(Progress& p)> work, Progress& progress);

} // namespace devseg
