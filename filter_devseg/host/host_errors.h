// What leaves the plugins when something fails: one exception with a text for the user.
#pragma once

#include <new>
#include <stdexcept>

#include "devseg/base/errors.h"
#include "host/vcg_bridge.h"

namespace devseg::host {

/// Why nothing was done.
struct HostError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Calls `work`, which may throw anything. Faces that an error is about get selected in `model`.
template <class Work>
auto with_host_errors(MeshModel& model, Work work) -> decltype(work()) {
    try {
        return work();
    } catch (const InvalidMesh& error) {
        if (!error.faces.empty())
            select_faces(model.cm, error.faces);
        throw HostError(error.what());
    } catch (const std::bad_alloc&) {
        throw HostError("expected enough memory for this mesh, found too little; "
                        "use a smaller mesh or close other programs");
    } catch (const std::exception& error) {
        throw HostError(error.what());
    }
}

} // namespace devseg::host
