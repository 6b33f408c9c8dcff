#include "host/observer.h"

namespace devseg::host {

namespace {

thread_local Observer observer_of_thread = nullptr;
thread_local Listener listener_of_thread = nullptr;

} // namespace

Progress::Callback progress_callback(vcg::CallBackPos* host) {
    return [host, observer = observer_of_thread](double fraction, const char* part) {
        if (observer != nullptr && observer(fraction, part) == 0)
            return false;
        return host == nullptr || host(static_cast<int>(100.0 * fraction), part);
    };
}

void tell(const std::vector<std::string>& notes) {
    if (listener_of_thread == nullptr)
        return;
    for (const std::string& note : notes)
        listener_of_thread(note.c_str());
}

} // namespace devseg::host

void devseg_observe(devseg::host::Observer observer) {
    devseg::host::observer_of_thread = observer;
}

void devseg_listen(devseg::host::Listener listener) {
    devseg::host::listener_of_thread = listener;
}
