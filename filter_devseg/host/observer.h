// Progress and notes for callers in the same process whose host passes none on: pymeshlab shows its
// users no progress, its callback never cancels, and after a filter has failed its log is not
// printed.
#pragma once

#include <string>
#include <vector>

#include "devseg/base/progress.h"
#include "host/meshlab_api.h"

namespace devseg::host {

/// Called with the fraction of the filter that is done, from 0 to 1, and the name of the part that
/// runs; returns 0 to cancel.
using Observer = int (*)(double fraction, const char* part);

/// Hears a note of a filter, which is also a line of the host's log.
using Listener = void (*)(const char* note);

/// Asks the observer of this thread, if it has one, and then the host.
Progress::Callback progress_callback(vcg::CallBackPos* host);

/// Tells the listener of this thread, if it has one.
void tell(const std::vector<std::string>& notes);

} // namespace devseg::host

extern "C" {

// The symbols that the plugin exports beside Qt's: the Python package calls them.

/// Sets the observer of all filters that this thread runs from now on; null for none.
__attribute__((visibility("default"))) void devseg_observe(devseg::host::Observer observer);

/// The same for the listener.
__attribute__((visibility("default"))) void devseg_listen(devseg::host::Listener listener);
}
