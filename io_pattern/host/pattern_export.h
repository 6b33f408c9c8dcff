// A host's mesh → a pattern file: all that does not depend on how a version of the host declares
// its plugins.
#pragma once

#include <string>
#include <vector>

#include "host/meshlab_api.h"

namespace devseg {

/// What the host asks for when it saves a pattern.
RichParameterList pattern_parameters();

struct SavedPattern {
    std::vector<std::string> notes;    // for the host's log
    std::vector<std::string> warnings; // for the user to see
};

/// Saves the pattern of a mesh with texture coordinates as SVG. Throws HostError; no file has been
/// written then.
SavedPattern save_pattern_svg(const std::string& file_name, MeshModel& model,
                              const RichParameterList& parameters, vcg::CallBackPos* callback);

} // namespace devseg
