// Running a filter of the table on a host's document: all that does not depend on how a version of
// the host declares its plugins.
#pragma once

#include <string>
#include <vector>

#include "devseg/declare/filter.h"
#include "host/meshlab_api.h"

namespace devseg::host {

struct HostRun {
    unsigned changed = 0; // elements of the mesh that were written, as bits of MeshModel
    declare::ResultValues values;
    std::vector<std::string> log; // lines for the host's log
};

/// Runs the filter on the current mesh of the document. Throws HostError; the mesh is as it was
/// then, apart from the selection of the faces that the error is about.
HostRun run_in_host(const declare::FilterDeclaration& filter, MeshDocument& document,
                    const RichParameterList& parameters, vcg::CallBackPos* callback);

/// What the filter may write, as bits of MeshModel.
int written_elements(const declare::FilterDeclaration& filter);

/// The filter's menu in the host's plugin interface.
template <class Interface>
typename Interface::FilterClass filter_class(const declare::FilterDeclaration& filter) {
    switch (filter.category) {
    case declare::FilterCategory::remeshing:
        return Interface::Remeshing;
    case declare::FilterCategory::texture:
        return Interface::Texture;
    case declare::FilterCategory::color:
        return Interface::FaceColoring;
    case declare::FilterCategory::measure:
        return Interface::Measure;
    }
    return Interface::Remeshing;
}

} // namespace devseg::host
