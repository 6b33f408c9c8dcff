// A host's mesh → a pattern file: all that does not depend on how a version of the host declares
// its plugins.
#pragma once

#include <string>
#include <vector>

#include "host/meshlab_api.h"

namespace devseg::host {

/// What the host asks for when it saves a pattern.
RichParameterList pattern_parameters();

/// Saves the pattern of a mesh with texture coordinates in the format of the file's extension, as
/// the filter 'Pattern: Export' does; returns what the user should know. Throws HostError; no file
/// has been written then.
std::vector<std::string> save_pattern(const std::string& file_name, MeshModel& model,
                                      const RichParameterList& parameters,
                                      vcg::CallBackPos* callback);

} // namespace devseg::host
