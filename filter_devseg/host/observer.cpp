#include "host/observer.h"

namespace devseg::host {

namespace {

thread_local Observer observer_of_thread = nullptr;

} // namespace

Progress::Callback progress_callback(vcg::CallBackPos* host) {
    return [host, observer = observer_of_thread](double fraction, const char* part) {
        if (observer != nullptr && observer(fraction, part) == 0)
            return false;
        return host == nullptr || host(static_cast<int>(100.0 * fraction), part);
    };
}

} // namespace devseg::host

void devseg_observe(devseg::host::Observer observer) {
    devseg::host::observer_of_thread = observer;
}
