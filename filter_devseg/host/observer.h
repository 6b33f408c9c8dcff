// Progress for callers in the same process whose host passes none on: pymeshlab shows its users no
// progress, and its callback never cancels.
#pragma once

#include "devseg/base/progress.h"
#include "host/meshlab_api.h"

namespace devseg::host {

/// Called with the fraction of the filter that is done, from 0 to 1, and the name of the part that
/// runs; returns 0 to cancel.
using Observer = int (*)(double fraction, const char* part);

/// Asks the observer of this thread, if it has one, and then the host.
Progress::Callback progress_callback(vcg::CallBackPos* host);

} // namespace devseg::host

extern "C" {

/// Sets the observer of all filters that this thread runs from now on; null for none. The only
/// symbol that the plugin exports beside Qt's: the Python package calls it.
__attribute__((visibility("default"))) void devseg_observe(devseg::host::Observer observer);
}
